"""`hitjoints sweep`: maps of inertia, speed and flux."""

from __future__ import annotations

import typer

from .hit_sources import told
from .option_groups import grouped, show_help
from .sweep_contact_time import sweep_contact_time
from .sweep_joint import sweep_joint
from .sweep_mass import sweep_mass
from .sweep_motion import sweep_motion
from .sweep_workspace import sweep_workspace

app = typer.Typer(help="Map inertia, speed and flux.")


@app.callback(invoke_without_command=True)
def root(context: typer.Context) -> None:
    """Map inertia, speed and flux: by joint angle, object mass, contact time, or place."""
    show_help(context)


app.command("joint")(grouped(sweep_joint, told))
app.command("contact-time")(grouped(sweep_contact_time, told))
app.command("mass")(grouped(sweep_mass, told))
app.command("motion")(grouped(sweep_motion, told))
app.command("workspace")(grouped(sweep_workspace, told))
