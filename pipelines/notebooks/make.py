"""Writes the notebooks from the cells below, executes them, and keeps what they print and draw.

    python make.py [NAME...] [--bare]

`--bare` leaves them without outputs. Needs the packages of crates/python/python_tests/requirements.txt.
"""

import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

HERE = Path(__file__).parent


def cells(path):
    """The cells of a script: text after `# %% [markdown]`, code after `# %%`."""
    kind, lines = None, []
    for line in [*path.read_text(encoding="utf-8").splitlines(), "# %%"]:
        if not line.startswith("# %%"):
            lines.append(line)
            continue
        content = "\n".join(lines).strip()
        if kind == "markdown":
            text = "\n".join(row.removeprefix("# ").removeprefix("#") for row in content.splitlines())
            yield nbformat.v4.new_markdown_cell(text)
        elif content:
            yield nbformat.v4.new_code_cell(content)
        kind, lines = ("markdown" if "[markdown]" in line else "code"), []


def notebook(path):
    """The notebook of a script; ids that follow from the order, so that the same cells give the same file."""
    made = nbformat.v4.new_notebook(cells=list(cells(path)))
    made.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    for i, cell in enumerate(made.cells):
        cell.id = f"cell-{i}"
    return made


def main():
    names = [argument for argument in sys.argv[1:] if not argument.startswith("-")]
    for path in sorted((HERE / "cells").glob("*.py")):
        if names and path.stem not in names:
            continue
        made = notebook(path)
        if "--bare" not in sys.argv:
            NotebookClient(made, timeout=3600, resources={"metadata": {"path": str(HERE)}}).execute()
            for cell in made.cells:
                cell.metadata.pop("execution", None)
        nbformat.write(made, HERE / f"{path.stem}.ipynb")
        print(HERE / f"{path.stem}.ipynb")


if __name__ == "__main__":
    main()
