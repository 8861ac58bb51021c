// SPDX-License-Identifier: GPL-3.0-or-later
// Fits patches to the mesh of a case and says how many there are.
#include <cstdio>

#include "fit/fit.h"
#include "io/case_folder.h"

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const kinelux::io::CaseFolder folder(argv[1]);
    const auto fitted = kinelux::fit::fit_patches(folder.read_scene(), {});
    std::printf("%zu patches\n", fitted.patches.patches.size());
    return 0;
}
