"""Check that a wheel puts only `hitjoints` into site-packages, with its robots and its types."""

import sys
import zipfile

EXPECTED = (
    "hitjoints/__init__.py",
    "hitjoints/py.typed",
    "hitjoints/cli/app.py",
    "hitjoints/evidence/recordings/examples/IIWA_14_hit_10.csv",
    "hitjoints/robots/iiwa14.urdf",
    "hitjoints/robots/panda.toml",
)

names = zipfile.ZipFile(sys.argv[1]).namelist()
tops = {name.split("/")[0] for name in names if ".dist-info/" not in name}
missing = [name for name in EXPECTED if name not in names]
if tops != {"hitjoints"} or missing:
    sys.exit(f"{sys.argv[1]}: top level {sorted(tops)}, missing {missing}")
