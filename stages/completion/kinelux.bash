# SPDX-License-Identifier: GPL-3.0-or-later
# Completes kinelux and its stages: commands and options as the programs' own --help lists them, else file names.
_kinelux() {
    local word=${COMP_WORDS[COMP_CWORD]} program=${COMP_WORDS[0]}
    local ask=("$program")
    COMPREPLY=()
    if [ "${program##*/}" = kinelux ]; then
        if [ "$COMP_CWORD" -eq 1 ]; then
            local commands
            commands=$("$program" --help 2>/dev/null | sed -n 's/^  *\([a-z-]*\)  .*/\1/p')
            mapfile -t COMPREPLY < <(compgen -W "$commands --help --version" -- "$word")
            return
        fi
        ask+=("${COMP_WORDS[1]}")
    fi
    if [[ $word == -* ]]; then
        local options
        options=$("${ask[@]}" --help 2>/dev/null | sed -n 's/^  *\(-[a-z], \)\{0,1\}\(--[a-z-]*\).*/\2/p')
        mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
    fi
}
complete -o default -F _kinelux kinelux kinelux-clean kinelux-fit kinelux-cluster kinelux-plan kinelux-coefficients \
    kinelux-solve kinelux-export kinelux-reference kinelux-study kinelux-report
