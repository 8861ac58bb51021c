// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>

#include "cli/stage.h"
#include "cluster/cluster.h"

using namespace kinelux;

int main(int argc, char** argv) {
    cli::Stage stage({.name = "cluster",
                      .summary = "Cuts patches into elements and gathers small triangles into clusters.",
                      .inputs = {"patches.h5"},
                      .outputs = {"clusters.h5", "clusters.vtu"}});
    std::optional<double> cluster_size;
    double normal_spread_deg = cluster::ClusterOptions{}.normal_spread_deg;
    stage.options().add({.member = &cluster_size,
                         .flags = "--cluster-size",
                         .help = "largest edge of a cluster's bounds",
                         .unit = "m",
                         .low = 1e-9,
                         .high = 1e9,
                         .unset = "from the accuracy"});
    stage.options().add({.member = &normal_spread_deg,
                         .flags = "--normal-spread",
                         .help = "largest angle to a cluster's mean normal",
                         .unit = "deg",
                         .low = 1.0,
                         .high = 90.0});
    return stage.run(argc, argv, [&](cli::Stage&) {
        const auto scene = stage.step("read scene", [&] { return stage.folder().read_scene(); });
        const auto patches = stage.step("read patches", [&] { return stage.folder().read_patches(); });
        cluster::ClusterOptions options = cluster::cluster_options_for(scene, patches);
        options.cluster_size = cluster_size.value_or(options.cluster_size);
        options.normal_spread_deg = normal_spread_deg;
        const auto tree = stage.step("cluster", [&] { return cluster::build_clusters(patches, options); });
        stage.step("write", [&] { stage.folder().write_clusters(tree, patches); });

        stage.count("elements", tree.elements.size());
        stage.count("clusters", tree.clusters.size());
        stage.figure("element size", options.element_size, "m");
        stage.figure("cluster size", options.cluster_size, "m");
        return core::ExitCode::Ok;
    });
}
