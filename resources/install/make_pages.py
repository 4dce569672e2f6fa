#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes manual pages and the completion for bash, zsh and fish from what the programs' own --help says.

make_pages.py --glint PROGRAM [--inspector PROGRAM] --out DIR     DIR/glint.1, DIR/glint-COMMAND.1, DIR/glint-inspector.1, DIR/glint.bash, DIR/_glint,
                                                                  DIR/glint.fish
"""
import argparse
import pathlib
import re
import subprocess


def help_of(program, *words):
    return subprocess.run([program, *words, "--help"], check=True, stdout=subprocess.PIPE, text=True).stdout.rstrip() + "\n"


def version_of(program):
    return subprocess.run([program, "--version"], check=True, stdout=subprocess.PIPE, text=True).stdout.split()[1]


def roff(text):
    """Text as written, in the page's fixed layout."""
    return "\n".join(r"\&" + line if line[:1] in ".'" else line
                     for line in text.replace("\\", r"\e").replace("-", r"\-").splitlines())


def manual(name, summary, text, version, also):
    heading = name.upper()
    page = f'.TH "{heading}" "1" "" "Glint {version}" "Glint"\n.SH NAME\n{roff(name)} \\- {roff(summary)}\n'
    usage = re.search(r"^Usage: (.*)$", text, re.M).group(1)
    body = text[text.index("Usage: "):].split("\n", 1)[1].strip("\n")
    page += f".SH SYNOPSIS\n.nf\n{roff(usage)}\n.fi\n.SH DESCRIPTION\n.nf\n{roff(body)}\n.fi\n"
    if also:
        page += ".SH SEE ALSO\n" + ", ".join(rf"\fB{roff(other)}\fR(1)" for other in also) + "\n"
    return page


def commands_in(text):
    """(command, summary) of `glint --help`."""
    block = text[text.index("Subcommands:"):].split("\n")[1:]
    found = []
    for line in block:
        match = re.match(r"  ([a-z][a-z-]+)\s{2,}(.*)$", line)
        if match:
            found.append(match.groups())
        elif found and not line.strip():
            break
    return found


def options_in(text):
    """Flags of a page, and the words that one of them takes where it takes one of several."""
    flags, choices = [], {}
    for match in re.finditer(r"^  ((?:-{1,2}[A-Za-z0-9-]+,?)+)(?: ([^ ]+))?", text, re.M):
        names = [flag for flag in match.group(1).split(",") if flag.startswith("--")]
        flags += names
        values = (match.group(2) or "").split("=")[0]
        if "|" in values and re.fullmatch(r"[a-z0-9|-]+", values):
            choices.update({name: values.split("|") for name in names})
    return flags, choices


def completion(commands, pages):
    lines = ["# SPDX-License-Identifier: BSD-3-Clause",
             "# Completion of glint for bash: commands, options and their words; file names elsewhere.",
             "_glint() {", "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]} flags= words=",
             '  if [ "$COMP_CWORD" = 1 ]; then',
             f'    COMPREPLY=($(compgen -W "{" ".join(name for name, _ in commands)} --help --version" -- "$word"))',
             "    return", "  fi", '  case "$command" in']
    for name, _ in commands:
        flags, choices = options_in(pages[name])
        lines.append(f"    {name})")
        lines.append(f'      flags="{" ".join(flags)}"')
        if choices:
            lines.append('      case "$before" in')
            lines += [f'        {flag}) words="{" ".join(values)}" ;;' for flag, values in sorted(choices.items())]
            lines.append("      esac")
        lines.append("      ;;")
    lines += ["  esac", '  if [ -n "$words" ]; then', '    COMPREPLY=($(compgen -W "$words" -- "$word"))',
              '  elif [ "${word:0:1}" = - ]; then',
              '    COMPREPLY=($(compgen -W "$flags" -- "$word"))', "  else", '    COMPREPLY=($(compgen -f -- "$word"))', "  fi",
              "}",
              "complete -o filenames -F _glint glint"]
    return "\n".join(lines) + "\n"


def in_quotes(text):
    """One word of any shell."""
    return "'" + text.replace("'", "\u2019") + "'"


def zsh_completion(commands, pages):
    lines = ["#compdef glint", "# SPDX-License-Identifier: BSD-3-Clause",
             "# Completion of glint for zsh: commands, options and their words; file names elsewhere.",
             "_glint() {", "  local -a commands flags", "  if (( CURRENT == 2 )); then", "    commands=("]
    lines += ["      " + in_quotes(name + ":" + summary) for name, summary in commands]
    lines += ["    )", "    _describe command commands", "    return", "  fi", "  case $words[2] in"]
    for name, _ in commands:
        flags, choices = options_in(pages[name])
        lines += [f"    {name})", f"      flags=({' '.join(flags)})"]
        if choices:
            lines.append("      case $words[CURRENT-1] in")
            lines += [f"        {flag}) compadd -- {' '.join(values)}; return ;;" for flag, values in sorted(choices.items())]
            lines.append("      esac")
        lines.append("      ;;")
    lines += ["  esac", "  if [[ $words[CURRENT] == -* ]]; then", "    compadd -- $flags", "  else", "    _files", "  fi", "}",
              '_glint "$@"']
    return "\n".join(lines) + "\n"


def fish_completion(commands, pages):
    lines = ["# SPDX-License-Identifier: BSD-3-Clause",
             "# Completion of glint for fish: commands, options and their words; file names elsewhere."]
    lines += [f"complete -c glint -n __fish_use_subcommand -f -a {name} -d {in_quotes(summary)}" for name, summary in commands]
    for name, _ in commands:
        flags, choices = options_in(pages[name])
        for flag in flags:
            words = f" -x -a {in_quotes(' '.join(choices[flag]))}" if flag in choices else ""
            lines.append(f"complete -c glint -n '__fish_seen_subcommand_from {name}' -l {flag[2:]}{words}")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--glint", required=True)
    parser.add_argument("--inspector")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    text, version = help_of(options.glint), version_of(options.glint)
    commands = commands_in(text)
    pages = {name: help_of(options.glint, name) for name, _ in commands}
    also = [f"glint-{name}" for name, _ in commands]
    (options.out / "glint.1").write_text(manual("glint", "predict specular highlights from a few images of a known scene", text,
                                                version, also + ["glint-inspector"]))
    for name, summary in commands:
        (options.out / f"glint-{name}.1").write_text(manual(f"glint-{name}", summary[0].lower() + summary[1:], pages[name],
                                                            version, ["glint"]))
    (options.out / "glint.bash").write_text(completion(commands, pages))
    (options.out / "_glint").write_text(zsh_completion(commands, pages))
    (options.out / "glint.fish").write_text(fish_completion(commands, pages))
    if options.inspector:
        (options.out / "glint-inspector.1").write_text(
            manual("glint-inspector", "show a reconstruction of specular highlights step by step", help_of(options.inspector),
                   version, ["glint"]))


main()
