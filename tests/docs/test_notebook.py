"""The notebook runs from its first cell to its last, and shows what it showed when it was kept."""

import nbformat
from markdown_pages import ROOT, says
from nbclient import NotebookClient

PAGE = ROOT / "docs" / "notebook.ipynb"


def outputs(notebook):
    """Return the texts and the number of figures of each code cell."""
    found = []
    for cell in notebook.cells:
        if cell.cell_type == "code":
            text, figures = "", 0
            for output in cell.outputs:
                data = output.get("data", {})
                drawn = "image/png" in data
                figures += drawn
                text += output.get("text", "") + ("" if drawn else data.get("text/plain", ""))
            found.append((text, figures))
    return found


def test_the_notebook_runs_and_shows_the_same(tmp_path):
    kept = outputs(nbformat.read(PAGE, as_version=4))
    again = nbformat.read(PAGE, as_version=4)
    where = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(again, timeout=120, kernel_name="python3", resources=where).execute()
    for (text, figures), (before, drawn) in zip(outputs(again), kept, strict=True):
        assert figures == drawn
        assert says(text, before), f"{text}\nwas\n{before}"
    assert sum(figures for _, figures in kept) >= 2
    assert (tmp_path / "hit.csv").stat().st_size > 1000
