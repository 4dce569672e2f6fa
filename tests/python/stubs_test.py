#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""stubs_test.py SOURCE PACKAGE [--write]: the type stubs of the extension module are what stubgen makes of it, and stubtest finds that they and the
annotations of the package say what is there. --write: makes the stubs."""
import ast
import importlib
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HEAD = "# SPDX-License-Identifier: BSD-3-Clause\n# Made by tests/python/stubs_test.py --write\n"


def signature(line):
    """"f(a: int, *, b: float = 0.5) -> str" as a stub writes it, or None where it is no signature."""
    try:
        function = ast.parse(f"def {line}: ...").body[0]
    except SyntaxError:
        return None
    for argument in [*function.args.args, *function.args.kwonlyargs]:
        if argument.arg == "self":
            argument.annotation = None
    arguments = function.args
    with_default = zip([*arguments.args[len(arguments.args) - len(arguments.defaults):], *arguments.kwonlyargs],
                       [*arguments.defaults, *arguments.kw_defaults])
    for argument, default in with_default:
        if isinstance(default, ast.Constant) and default.value is None and argument.annotation:
            kind = ast.unparse(argument.annotation)
            if not kind.startswith("Optional") and kind != "object":
                argument.annotation = ast.parse(f"Optional[{kind}]").body[0].value
    function.args.defaults = [ast.Constant(...) for _ in function.args.defaults]
    function.args.kw_defaults = [d and ast.Constant(...) for d in function.args.kw_defaults]
    return ast.unparse(function).replace(":\n    ...", ": ...")


def mended(text):
    """Where stubgen (of mypy 1.0) gives up, or forgets None, the signatures that pybind11 writes say more: static methods, arguments behind a *,
    "or None" in the words of a property."""
    module = importlib.import_module("glint._glint")
    lines, owner, is_property = [], module, False
    for line in text.split("\n"):
        if found := re.match(r"class (\w+)", line):
            owner = getattr(module, found[1])
        elif line and not line.startswith(" "):
            owner = module
        if found := re.match(r"( *)def (\w+)\((.*)\) -> (.*): \.\.\.$", line):
            indent, name, _, result = found.groups()
            there = owner.__dict__.get(name)
            words = (getattr(getattr(there, "__func__", there), "__doc__", None) or "").strip()
            said = signature(words.split("\n")[0]) if not is_property else None
            if re.match("_[a-z]", name):  # for the package alone, which has annotations of its own
                if isinstance(there, staticmethod):
                    lines.append(indent + "@staticmethod")
                mine = "self" if owner is not module and not isinstance(there, staticmethod) else ""
                rest = "" if is_property else "*args: Any, **kwargs: Any"
                line = f"{indent}def {name}({', '.join(filter(None, [mine, rest]))}) -> Any: ..."
            elif said:
                if isinstance(there, staticmethod):
                    lines.append(indent + "@staticmethod")
                line = indent + said
            elif is_property:
                # "(self: glint._glint.Camera) -> str": what the getter says, not what its words look like.
                getter = re.match(r"\(.*\) -> (.*)$", (there.fget.__doc__ or "").strip().split("\n")[0])
                kind = getter[1] if getter else result
                kind = re.sub(r"numpy\.ndarray\[[^]]*\]", "numpy.ndarray", kind)
                if "or None" in words and not kind.startswith("Optional"):
                    kind = f"Optional[{kind}]"
                line = f"{indent}def {name}(self) -> {kind}: ..."
        is_property = line.strip() == "@property"
        lines.append(line)
    return "\n".join(lines)


def made(package):
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([sys.executable, "-c", "from mypy.stubgen import main; main()", "-q", "-m", "glint._glint", "-o", folder],
                              env={**os.environ, "PYTHONPATH": package}, capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(done.stdout + done.stderr)
        text = (pathlib.Path(folder) / "glint/_glint.pyi").read_text()
    sys.path.insert(0, package)
    text = mended(text).replace("glint._glint.", "")
    text = re.sub(r"^from typing import .*\n", "", text, flags=re.M)
    text = re.sub(r"^ *def __reduce(_ex)?__\(.*\n", "", text, flags=re.M)  # they refuse what object promises: that is no other signature
    text = re.sub(r"\b(\w+)\[(\d+)\]", r"List[\1]", text)  # a C++ array of two numbers
    text = re.sub(r": ClassVar\[str\] = \.\.\.", ": str", text)  # of exceptions: every instance has its own
    text = text.replace("\nclass ", "\n__version__: str\n\nclass ", 1)
    names = [n for n in ("Any", "Dict", "List", "Optional", "Tuple", "Union") if re.search(rf"\b{n}\b", text)]
    return HEAD + f"from typing import {', '.join(names)}\n\nfrom numpy.typing import ArrayLike\n" + text


def main():
    source, package = pathlib.Path(sys.argv[1]), sys.argv[2]
    if importlib.util.find_spec("mypy") is None:
        print("skipped: the package mypy is not installed")
        sys.exit(77)
    if not list(pathlib.Path(package).glob("glint/_glint.*.so")):
        print("skipped: the Python module was not built; it needs python3-dev, python3-numpy and pybind11-dev")
        sys.exit(77)
    file, text = source / "plugins/python/glint/_glint.pyi", made(package)
    if "--write" in sys.argv:
        file.write_text(text)
        return
    if not file.exists() or file.read_text() != text:
        sys.exit(f"{file.name} is not what stubgen makes of the module; run this test with --write")
    done = subprocess.run([sys.executable, "-c", "import sys; from mypy.stubtest import main; sys.exit(main())", "glint", "--ignore-missing-stub",
                           "--concise"], env={**os.environ, "PYTHONPATH": package, "MYPYPATH": package}, cwd=package, capture_output=True, text=True,
                          check=False)
    # A class of pybind11 has a metaclass that no stub can name.
    wrong = [line for line in (done.stdout + done.stderr).splitlines() if line and not line.endswith("is inconsistent, metaclass differs")]
    classes = done.stdout.count("metaclass differs")
    print(*wrong, f"{classes} classes compared", sep="\n")
    sys.exit(1 if wrong or classes < 30 else 0)


main()
