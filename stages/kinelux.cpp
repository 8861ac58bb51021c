// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>

#include "cli/driver.h"
#include "cli/program.h"
#include "form_factors.h"

using namespace kinelux;

int main(int argc, char** argv) {
    const std::array<cli::Command, 3> commands{
        {{"run", "all stages, only what is stale", cli::run_command},
         {"form-factors", "form factors between objects or patches as CSV", stages::form_factors_command},
         {"info", "what a scene, a mesh, a file of a case or a case is", cli::info_command}}};
    return cli::run_program("kinelux", argc, argv, [&](const std::vector<std::string>& arguments) {
        return cli::drive(arguments, commands);
    });
}
