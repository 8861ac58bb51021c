// SPDX-License-Identifier: GPL-3.0-or-later
// Prints the table of docs/validation.md: every closed form beside what the program makes of it.
#include <fmt/format.h>

#include "closed_form_cases.h"

int main() {
    using namespace kinelux::validation;
    fmt::print("| case | source | closed form | at 1e-6 | relative error | relative error at 1e-3 |\n"
               "|---|---|---|---|---|---|\n");
    for (const ClosedFormCase& item : closed_form_cases()) {
        const double fine = computed_factor(item, 1e-6), usual = computed_factor(item, 1e-3);
        fmt::print("| {} | {} | {:.10f} | {:.10f} | {:.1e} | {:.1e} |\n", item.name, item.source,
                   item.expected, fine, fine / item.expected - 1.0, usual / item.expected - 1.0);
    }
    return 0;
}
