"""Where the packages are that descriptions speak of, without ROS."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from xml.etree import ElementTree


def packages(package: str, folder: str, package_dirs: Sequence[str] = ()) -> Iterator[Path]:
    """Yield the folders that may be a package, the likeliest first, whether they exist or not.

    Those are `package_dirs`, the folders above the description (one called so, one whose
    package.xml says so, or one beside), ROS_PACKAGE_PATH and AMENT_PREFIX_PATH.

    Args:
        package: its name.
        folder: where the description is.
        package_dirs: folders that hold packages, or are one.
    """
    for given in map(Path, package_dirs):
        yield given / package
        if _is_package(given.resolve(), package):
            yield given
    here = Path(folder).absolute()
    true = here.resolve()  # where a link to the description leads
    for above in dict.fromkeys((here, *here.parents, true, *true.parents)):
        if _is_package(above, package):
            yield above
        yield above / package
    for entry in filter(None, os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)):
        yield Path(entry, package)
        if _is_package(Path(entry), package):
            yield Path(entry)
    for prefix in filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)):
        yield Path(prefix, "share", package)


def _is_package(folder: Path, package: str) -> bool:
    """Tell whether a folder is a package, by its name or by what its package.xml says."""
    if folder.name == package:
        return True
    try:
        return ElementTree.parse(folder / "package.xml").findtext("name", "").strip() == package
    except (OSError, ValueError, ElementTree.ParseError):
        return False
