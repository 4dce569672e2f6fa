# SPDX-License-Identifier: BSD-3-Clause
"""Manual pages and completion, made from the program's help, tried in the shells that are installed.

pages_test.py GLINT
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
# zsh completes on a terminal only; its functions are replaced by ones that print what they would offer.
ZSH = """
compadd() { shift; print -l -- "$@" }
_describe() { print -l -- "${(@P)2}" }
_files() { print files }
words=("${@:2}"); CURRENT=${#words}
source $1
"""
BASH = 'source "$1"; COMP_WORDS=("${@:2}"); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _glint; printf "%s\\n" "${COMPREPLY[@]}"'


def out(*command):
    return subprocess.run([str(c) for c in command], check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()


def offered(shell, folder, words):
    if shell == "bash":
        return out("bash", "-c", BASH, "bash", folder / "glint.bash", *words)
    if shell == "zsh":
        return [line.split(":")[0] for line in out("zsh", "-f", "-c", ZSH, "zsh", folder / "_glint", *words) if line.startswith(words[-1])]
    line = " ".join(words)
    return [word.split("\t")[0] for word in out("fish", "--no-config", "-c", f"source {folder}/glint.fish; complete -C '{line}'")]


def main():
    glint = sys.argv[1]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        out(sys.executable, "-B", ROOT / "resources/install/make_pages.py", "--glint", glint, "--out", folder)
        commands = [line.split()[0] for line in out(glint, "--help") if line.startswith("  ") and line[2:3].isalpha() and "  " in line.strip()]
        assert "evaluate" in commands and "share" in commands
        for command in commands:
            page = (folder / f"glint-{command}.1").read_text()
            assert page.startswith(f'.TH "GLINT-{command.upper()}"') and ".SH SYNOPSIS" in page, command
            if shutil.which("man"):
                subprocess.run(["man", "--warnings", "-l", str(folder / f"glint-{command}.1")], check=True, stdout=subprocess.DEVNULL)
        tried = []
        for shell in ("bash", "zsh", "fish"):
            if not shutil.which(shell):
                print(f"{shell} is not installed: not tried")
                continue
            tried.append(shell)
            assert "evaluate" in offered(shell, folder, ["glint", "ev"]), shell
            assert {"--models", "--train"} <= set(offered(shell, folder, ["glint", "share", "--"])), shell
            assert {"radiance", "image"} <= set(offered(shell, folder, ["glint", "evaluate", "--source", ""])), shell
            assert "--ball" not in offered(shell, folder, ["glint", "share", "--"]), shell
        print("completion tried in", ", ".join(tried))


main()
