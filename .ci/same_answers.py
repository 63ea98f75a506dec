"""Ask two builds the same questions: the JSON of their commands has to be the same to the last bit.

    python .ci/same_answers.py BEFORE AFTER

BEFORE and AFTER are `hitjoints` programs, each in an environment of its own. Wall times and the
paths of what was written are left out; nothing else is. ProxQP's last digit depends on where its
memory lies, so that a build may differ from itself: where the first answers differ, each side is
asked up to eight times, and one answer has to be common to both. Ends with 1 if none is.
"""

import json
import os
import re
import subprocess
import sys
import tempfile

TRIES = 8

TIMES = {"step_time_us", "seconds", "elapsed", "wall_time"}

COMMANDS = """
inspect
inspect --robot iiwa14_bullet --joint 7 --direction 1,0,0 --mass 0.5
inspect --robot iiwa7 --joint 5
inspect --robot panda --joint 6 --offset 0.02,0,0.05
inspect --robot xarm7 --joint 4 --direction 0.3,0.2,-1
robots list
robots check iiwa14
robots check iiwa14_bullet
robots check iiwa7
robots check panda
robots check xarm7
sweep joint --count 200
sweep joint --robot panda --object 0.4,0.2,0.5 --joint 5 --joint 6 --count 100
sweep joint --robot xarm7 --object 0.3,0.2,0.4 --direction 1,1,0 --mass 0.7 --count 100
sweep workspace --x=0.3:0.6:4 --y=0.2:0.4:3 --z=0.5 --samples 50 --out {out}/map.zarr
sweep workspace --robot iiwa7 --x=0.3:0.6:4 --y=0.2:0.4:3 --z=0.3 --samples 9 --out {out}/b.zarr
plan
plan --robot iiwa7 --object 0.4,0.2,0.4
plan --robot panda --object 0.4,0.2,0.5 --objective flux
plan --robot xarm7 --object 0.3,0.2,0.4 --objective straight-flux --joint 6
plan --objective rebound --flux 0.3 --joint 6 --joint 7
plan --no-away --joint 5 --objective flux
plan --joint 6 --margin 0.01
plan --joint 7 --torque-limits
plan --object 2,0,0.5
rollout
rollout --joint 7 --flux 0.2 --reference constant
rollout --law paper --joint 6 --flux 0.2
rollout --robot iiwa7 --object 0.4,0.2,0.4 --joint 6 --flux 0.2
rollout --robot panda --object 0.4,0.2,0.5 --joint 6 --flux 0.2
rollout --joint 6 --flux 0.2 --torque-limits
simulate
simulate --joint 7 --flux 0.2 --restitution 0.5
simulate --realistic --joint 6 --flux 0.2
replay
reproduce fig2 --out {out}/paper
reproduce fig4 --out {out}/paper
"""


def asked(program: str, words: list[str], out: str) -> object:
    """Return exit code and JSON of a command."""
    command = [program, *(word.format(out=out) for word in words), "--json"]
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        command, capture_output=True, text=True, env=environment, cwd=out, timeout=600, check=False
    )
    answer = json.loads(done.stdout) if done.stdout.strip() else done.stderr
    return done.returncode, stripped(answer, out)


def stripped(value: object, out: str) -> object:
    """Return the answer without wall times and without the folders of outputs and builds."""
    if isinstance(value, dict):
        return {k: stripped(v, out) for k, v in value.items() if k not in TIMES}
    if isinstance(value, list):
        return [stripped(v, out) for v in value]
    if isinstance(value, str):
        return re.sub(r"/\S*/hitjoints/evidence/", "", value.replace(out, "OUT"))
    return value


def main(before: str, after: str) -> int:
    """Compare every command and print what differs."""
    different = 0
    commands = [line.split() for line in COMMANDS.strip().splitlines()]
    for words in commands:
        given: tuple[list[object], list[object]] = ([], [])
        for _ in range(TRIES):
            for answers, program in zip(given, (before, after), strict=True):
                with tempfile.TemporaryDirectory() as out:
                    answers.append(asked(program, words, out))
            same = any(answer in given[1] for answer in given[0])
            if same:
                break
        different += not same
        print(f"{'same' if same else 'DIFFERENT':10}{len(given[0])}  {' '.join(words)}", flush=True)
    print(f"{len(commands) - different} of {len(commands)} commands answer the same")
    return int(different > 0)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
