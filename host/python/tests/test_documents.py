"""Examples of the documents, the package's own examples, and the notebooks run."""

from __future__ import annotations

import doctest
import json
import re
from pathlib import Path

import arcfeed
import nbclient
import nbformat
import pytest
from conftest import ROOT

DOCUMENTS = [ROOT / "docs/python.md", ROOT / "host/python/README.md"]
NOTEBOOKS = sorted((ROOT / "examples/notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_examples_of_a_document_run(document: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    examples = re.findall(r"^```python\n(.*?)^```", document.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert examples
    # Examples name files as seen from the root, and write into the folder `out`.
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    (tmp_path / "out").mkdir()
    names: dict[str, object] = {}
    for example in examples:
        exec(compile(example, str(document), "exec"), names)  # noqa: S102


def test_examples_of_the_package_run() -> None:
    modules = [arcfeed, arcfeed._job]
    results = [doctest.testmod(module) for module in modules]
    assert all(result.failed == 0 for result in results) and sum(result.attempted for result in results) > 4


def test_there_are_three_notebooks_without_stored_output() -> None:
    assert len(NOTEBOOKS) == 3
    for notebook in NOTEBOOKS:
        for cell in json.loads(notebook.read_text(encoding="utf-8"))["cells"]:
            assert not cell.get("outputs") and cell.get("execution_count") is None, notebook.name


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(notebook: Path) -> None:
    content = nbformat.read(notebook, as_version=4)  # type: ignore[no-untyped-call]
    client = nbclient.NotebookClient(
        content, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(notebook.parent)}}
    )
    client.execute()
