// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/view_script.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "core/run_record.h"
#include "io/case_views.h"
#include "io/scene_json.h"

namespace kinelux::io {

namespace {

using Json = nlohmann::ordered_json;

/// What a camera that looks along a direction sees of the faces: the area whose front it sees, and the area near the
/// camera that is hidden because only fronts are drawn, both projected [m2].
struct Prospect {
    double shown = 0.0, hidden = 0.0;
};

Prospect prospect(const model::Scene& scene, const ViewScriptOptions& options, const Vec3& direction) {
    // The back of a block inside the room is no wall between the camera and the room: only the near part counts.
    constexpr double near_share = 0.2;
    const Vec3 centre = 0.5 * (options.low + options.high);
    const double depth = glm::dot(options.high - options.low, glm::abs(direction));
    const double nearest = glm::dot(centre, direction) - 0.5 * depth;
    Prospect result;
    for (const model::Object& object : scene.objects) {
        const model::Mesh& mesh = object.mesh;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const auto& [a, b, c] = mesh.triangles[t];
            const Vec3 normal =
                0.5 * glm::cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]);
            const double facing = -glm::dot(normal, direction);
            const Vec3 middle = (mesh.points[a] + mesh.points[b] + mesh.points[c]) / 3.0;
            const bool both = t < mesh.two_sided.size() && mesh.two_sided[t] != 0;
            if (facing > 0.0 || both)
                result.shown += std::abs(facing);
            else if (glm::dot(middle, direction) < nearest + near_share * depth)
                result.hidden -= facing;
        }
    }
    return result;
}

/// Two horizontal directions at right angles, along the world's axes where `up` is one of them.
std::array<Vec3, 2> horizontal_axes(const Vec3& up) {
    // The first is the axis farthest from up, x before y before z: a z-up scene is looked at along y, a y-up one along z.
    int axis = 0;
    for (int k = 1; k < 3; ++k)
        if (std::abs(up[k]) < std::abs(up[axis]) - 1e-9) axis = k;
    Vec3 first(0.0);
    first[axis] = 1.0;
    first = glm::normalize(first - glm::dot(first, up) * up);
    return {first, glm::cross(up, first)};
}

/// Area of the bounding box as seen along one of two horizontal axes [m2].
double box_front(const ViewScriptOptions& options, const Vec3& right, const Vec3& up) {
    const Vec3 size = glm::max(options.high - options.low, Vec3(0.0));
    return glm::dot(size, glm::abs(right)) * glm::dot(size, glm::abs(up));
}

/// Direction from the scene to the camera. A room that is open on one side and has a wall opposite is looked into straight
/// from there. Everything else is looked at from above and aside: only fronts are drawn, so that the walls between camera
/// and room vanish.
Vec3 direction_to_eye(const model::Scene& scene, const ViewScriptOptions& options, const Vec3& up) {
    constexpr double open_share =
        0.05; // hidden area, relative to what is shown, that still counts as an open side
    constexpr double wall_share = 0.5; // of the box's front that a wall opposite fills
    constexpr double aside_rad = 0.5, above_rad = 0.5;
    const auto [side, forward] = horizontal_axes(up);
    Vec3 best = forward;
    double best_score = std::numeric_limits<double>::lowest();
    bool open = false;
    for (const Vec3& direction : {forward, -forward, side, -side}) {
        const auto [shown, hidden] = prospect(scene, options, direction);
        const double front = box_front(options, glm::cross(direction, up), up);
        // Rounding must not decide between sides that are alike: the first one wins.
        const double score = std::round(1e6 * (shown - 0.5 * hidden) / std::max(front, 1e-300));
        if (score <= best_score) continue;
        best = direction;
        best_score = score;
        open = hidden <= open_share * shown && shown >= wall_share * front;
    }
    if (open) return -best;
    const Vec3 level = std::sin(aside_rad) * glm::cross(best, up) - std::cos(aside_rad) * best;
    return std::cos(above_rad) * level + std::sin(above_rad) * up;
}

Json to_json(const Vec3& v) { return {v.x, v.y, v.z}; }

Json camera_json(const model::Scene& scene, const ViewScriptOptions& options) {
    const Vec3 up = glm::length(scene.view.up) > 0.0 ? glm::normalize(scene.view.up) : Vec3(0.0, 0.0, 1.0);
    Json camera{{"up", to_json(up)}, {"field_of_view_deg", scene.view.field_of_view_deg}};
    camera["eye"] = scene.view.eye ? to_json(*scene.view.eye) : Json(nullptr);
    camera["target"] = scene.view.target ? to_json(*scene.view.target) : Json(nullptr);
    camera["direction_to_eye"] = to_json(direction_to_eye(scene, options, up));
    return camera;
}

std::string case_json(const model::Scene& scene, const ViewScriptOptions& options) {
    const std::string unit = model::irradiance_unit(scene.quantity);
    const bool empty = !(options.low.x <= options.high.x);
    Json json;
    json["title"] = scene.title;
    json["irradiance"] = array_name("Irradiance", unit);
    json["irradiance_high"] = options.irradiance_high;
    json["has_color"] = options.exposure > 0.0;
    json["exposure"] = options.exposure;
    json["low"] = to_json(empty ? Vec3(0.0) : options.low);
    json["high"] = to_json(empty ? Vec3(1.0) : options.high);
    json["camera"] = camera_json(scene, options);
    json["objects"] = object_names(scene);
    std::string text = json.dump(2, ' ', true, Json::error_handler_t::replace);
    // It stands between ''' in Python; a quote can only be inside a JSON string.
    for (std::size_t at = 0; (at = text.find('\'', at)) != std::string::npos;) text.replace(at, 1, "\\u0027");
    return text;
}

constexpr const char* script_begin = R"py(# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows the case in this folder.

  paraview --script=view.py                     with windows and a time slider
  pvbatch view.py --png picture.png [--frame N] [--size 1280x960]
          [--array NAME [--component N] [--log]] draws one picture
"""
import argparse
import json
import os
import sys

import paraview.simple
from paraview.simple import *

FROM_GUI = getattr(paraview, 'fromGUI', False)
CASE = json.loads(r''')py";

constexpr const char* script_end = R"py(''')


def case_folder():
    """The folder of this file; some ParaViews run scripts without telling them their name."""
    candidates = [globals().get('__file__')]
    try:
        with open('/proc/self/cmdline', 'rb') as arguments:
            words = arguments.read().decode(errors='replace').split('\0')
        candidates += [word.split('=', 1)[-1] for word in words if word.endswith('view.py')]
    except OSError:
        pass
    candidates.append(os.path.join(os.getcwd(), 'view.py'))
    for candidate in candidates:
        if candidate:
            folder = os.path.dirname(os.path.abspath(candidate))
            if os.path.isfile(os.path.join(folder, 'view.pvd')):
                return folder
    raise RuntimeError('view.pvd not found: start this script in the folder of the case')


def arguments():
    parser = argparse.ArgumentParser(prog='view.py', description='Shows a Kinelux case in ParaView.')
    parser.add_argument('--png', help='file of a picture to draw')
    parser.add_argument('--frame', type=int, default=0, help='number in the order of time, from 0; negative: from the end')
    parser.add_argument('--size', default='1280x960', help='of the picture, WIDTHxHEIGHT in pixels')
    parser.add_argument('--array', help='what is coloured by; default: the colours a camera would see, or irradiance')
    parser.add_argument('--component', type=int, help='of the array, from 0; default: the mean of all')
    parser.add_argument('--log', action='store_true', help='logarithmic colours')
    words = sys.argv[1:] if len(getattr(sys, 'argv', [])) > 1 and not FROM_GUI else []
    return parser.parse_args(words)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = dot(a, a) ** 0.5
    return [x / length for x in a]


def place_camera(view, size):
    """The scene's camera; where it says nothing, one that the whole scene just fits into."""
    from math import radians, tan
    camera = CASE['camera']
    low, high = CASE['low'], CASE['high']
    centre = [0.5 * (a + b) for a, b in zip(low, high)]
    target, eye = camera['target'] or centre, camera['eye']
    if eye is None:
        towards = unit(camera['direction_to_eye'])
        right = unit(cross(camera['up'], towards))
        above = cross(towards, right)
        slope = tan(radians(camera['field_of_view_deg']) / 2)
        distance = 0.0
        for corner in range(8):
            point = [(high if corner >> axis & 1 else low)[axis] - target[axis] for axis in range(3)]
            spread = max(abs(dot(point, above)) / slope, abs(dot(point, right)) / (slope * size[0] / size[1]))
            distance = max(distance, 1.05 * spread + dot(point, towards))
        eye = [t + distance * d for t, d in zip(target, towards)]
    view.CameraPosition, view.CameraFocalPoint = eye, target
    view.CameraViewUp = camera['up']
    view.CameraViewAngle = camera['field_of_view_deg']
    view.CenterOfRotation = centre


def titled(name):
    """'Irradiance_W_m2' -> 'Irradiance [W/m2]'"""
    for ending, shown in (('_W_m2', 'W/m2'), ('_lm_m2', 'lm/m2'), ('_lx', 'lx'), ('_m', 'm')):
        if name.endswith(ending):
            return '%s [%s]' % (name[:-len(ending)], shown)
    return name


def find_array(source, name):
    for association, data in (('POINTS', source.PointData), ('CELLS', source.CellData)):
        if name in data.keys():
            return association, data.GetArray(name)
    raise RuntimeError('there is no array %s; there are: %s' % (
        name, ', '.join(sorted(source.PointData.keys() + source.CellData.keys()))))


def colour_by_names(display, name):
    ColorBy(display, ('CELLS', name))
    table = GetColorTransferFunction(name)
    table.InterpretValuesAsCategories = 1
    table.Annotations = [word for number, object_name in enumerate(CASE['objects'])
                         for word in (str(number), object_name)]
    hues = ['%s' % c for c in '4e79a7 f28e2b 59a14f e15759 76b7b2 edc948 b07aa1 ff9da7 9c755f bab0ac'.split()]
    colours = [int(hues[n % len(hues)][2 * k:2 * k + 2], 16) / 255 for n in range(len(CASE['objects'])) for k in range(3)]
    table.IndexedColors = colours
    return table, 'Object'


def value_range(source, name, association, component):
    """Ends of the colour map: one for all irradiances and all frames; else of this frame, without its extremes."""
    low, high = find_array(source, name)[1].GetRange(component)
    if name.split('_')[0] in ('Irradiance', 'Direct', 'Indirect') and CASE['irradiance_high'] > 0.0:
        return 0.0, CASE['irradiance_high']
    try:
        import numpy
        from vtkmodules.util.numpy_support import vtk_to_numpy
        data = paraview.servermanager.Fetch(source)
        data = data.GetPointData() if association == 'POINTS' else data.GetCellData()
        values = vtk_to_numpy(data.GetArray(name))
        return low, float(numpy.percentile(values if values.ndim == 1 else values[:, component], 98))
    except (ImportError, AttributeError):
        return low, high


def colour_by_values(source, view, name, component, log):
    """Colours by a scalar, or by the mean or one component of a vector; returns what is shown and its colour table."""
    association, array = find_array(source, name)
    count = array.GetNumberOfComponents()
    label = titled(name)
    shown = source
    if count > 1 and component is None:
        if count == 3:
            shown = Calculator(registrationName='mean of ' + name, Input=source)
            shown.AttributeType = 'Point Data' if association == 'POINTS' else 'Cell Data'
            shown.ResultArrayName = name + '_mean'
            shown.Function = 'dot("%s", iHat + jHat + kHat) / 3' % name
            shown.UpdatePipeline()
            name, count, label = shown.ResultArrayName, 1, label + ', mean of channels'
        else:
            component = 0
    display = Show(shown, view)
    key = (association, name) if count == 1 else (association, name, array.GetComponentName(component) or str(component))
    ColorBy(display, key)
    if count > 1:
        label = '%s, %s' % (label, array.GetComponentName(component) or component)
    table = GetColorTransferFunction(name)
    if count > 1:
        table.VectorMode, table.VectorComponent = 'Component', component
    low, high = value_range(shown, name, association, 0 if count == 1 else component)
    if log:
        low = max(low, 1e-3 * high)
    if not high > low:
        high = low + (abs(low) or 1.0)
    table.ApplyPreset('Inferno (matplotlib)', True)
    table.RescaleTransferFunction(low, high)
    if log:
        table.MapControlPointsToLogSpace()
        table.UseLogScale = 1
    return display, table, label


def set_if_there(proxy, name, value):
    """Properties come and go between ParaView versions; none of these is worth failing for."""
    try:
        setattr(proxy, name, value)
    except (AttributeError, ValueError, RuntimeError):
        pass


def flat_light(view, display):
    """What is shown is what was computed: no lamp of ParaView's own, only fronts of faces."""
    set_if_there(view, 'UseLightKit', 0)
    for name, value in (('Ambient', 1.0), ('Diffuse', 0.0), ('Specular', 0.0),
                        ('BackfaceRepresentation', 'Cull Backface')):
        set_if_there(display, name, value)


def new_view(size):
    view = GetActiveViewOrCreate('RenderView')
    if not FROM_GUI:
        view.ViewSize = size
    set_if_there(view, 'UseColorPaletteForBackground', 0)
    set_if_there(view, 'BackgroundColorMode', 'Single Color')
    view.Background = [0.13, 0.14, 0.16]
    view.OrientationAxesVisibility = 0
    return view


def main():
    # ParaView would move the camera at the first picture.
    getattr(paraview.simple, '_DisableFirstRenderCameraReset', lambda: None)()
    options = arguments()
    size = [int(length) for length in options.size.lower().split('x')]
    source = PVDReader(registrationName='view.pvd', FileName=os.path.join(case_folder(), 'view.pvd'))
    scene = GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    times = list(source.TimestepValues)
    if not times:
        raise RuntimeError('view.pvd names no frame')
    if not -len(times) <= options.frame < len(times):
        raise RuntimeError('there is no frame %d: frames 0 to %d' % (options.frame, len(times) - 1))
    view = new_view(size)
    scene.AnimationTime = times[options.frame]
    source.UpdatePipeline(times[options.frame])

    name = options.array or ('Color' if CASE['has_color'] else CASE['irradiance'])
    table = None
    if name == 'Color':
        display = Show(source, view)
        ColorBy(display, ('POINTS', 'Color'))
        display.MapScalars = 0
        display.SetScalarBarVisibility(view, False)
    elif name == 'ObjectId':
        display = Show(source, view)
        table, label = colour_by_names(display, name)
    else:
        display, table, label = colour_by_values(source, view, name, options.component, options.log)
    if table is not None:
        bar = GetScalarBar(table, view)
        bar.Title, bar.ComponentTitle = label, ''
        display.SetScalarBarVisibility(view, True)
    flat_light(view, display)
    if FROM_GUI:
        size = list(view.ViewSize)
    place_camera(view, size)
    view.ViewTime = times[options.frame]
    Render(view)
    if options.png:
        SaveScreenshot(options.png, view, ImageResolution=size)
    elif not FROM_GUI and 'pvpython' in os.path.basename(sys.executable):
        Interact(view)


main()
)py";

} // namespace

std::string view_script(const model::Scene& scene, const ViewScriptOptions& options) {
    return script_begin + case_json(scene, options) + script_end;
}

} // namespace kinelux::io
