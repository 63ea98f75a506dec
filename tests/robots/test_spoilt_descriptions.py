"""Random damage to descriptions ends in a robot or in one line, never in anything else."""

import random
import re
import warnings

import pytest

import hitjoints as hj
from hitjoints.loading.catalogue import erd_urdfs
from hitjoints.loading.check import check_arm, check_shapes
from hitjoints.loading.load import read_robot

CASES = 250  # for each seed
TEXTS = [
    "",
    "nan",
    "inf",
    "1e400",
    "1,5",
    "1 2",
    "\uff11",
    "9" * 400,
    "0x10",
    "[",
    "<",
    "\0",
    "base",
]
NUMBERS = ["0", "-1", "1e9", "1e-30", "-1e-9", "-1e308", "1e308", "nan", "7_0", "1.5 "]
PARTS = ["<mimic joint='x'/>", "<inertial/>", "<limit/>", "<xacro:a/>", "<collision/>", "<axis/>",
         "<origin xyz=''/>", "</link>", "<joint/>", "<!--"]  # fmt: skip
KINDS = ["revolute", "fixed", "continuous", "prismatic", "floating", "planar", "ball"]


def replaced(text, pattern, group, chance, words):
    """Return a text with one of the matches of a pattern replaced by one of some words."""
    found = list(re.finditer(pattern, text, re.DOTALL))
    if not found:
        return text
    one = chance.choice(found)
    return text[: one.start(group)] + chance.choice(words) + text[one.end(group) :]


def spoilt(text, chance):
    names = re.findall(r'(?:link|name)="([^"]*)"', text) or [""]
    at = chance.randrange(len(text))
    ways = [
        lambda: replaced(text, r'"([^"]*)"', 1, chance, TEXTS),
        lambda: replaced(text, r"-?\d+\.?\d*(e-?\d+)?", 0, chance, NUMBERS),
        lambda: replaced(text, r'(link|joint|name)="([^"]*)"', 2, chance, names),
        lambda: replaced(text, r"<(\w+)[^>]*/>", 0, chance, [""]),
        lambda: replaced(text, r"<(joint|link) .*?</\1>", 0, chance, [""]),
        lambda: replaced(text, r'type="(\w+)"', 1, chance, KINDS),
        lambda: text[:at] + chance.choice("<>\"'&/= \n\0") + text[at + 1 :],
        lambda: text[:at] + chance.choice(PARTS) + text[at:],
        lambda: text[:at],
    ]
    return chance.choice(ways)()


@pytest.fixture(scope="module")
def texts():
    known = erd_urdfs()
    names = ("ur5_robot", "z1", "so101", "kinova", "double_pendulum")
    return [hj.load_robot("iiwa14").xml, *(known[name].read_text() for name in names)]


@pytest.mark.parametrize("seed", range(2))
def test_damage_ends_in_a_robot_or_a_line(texts, seed, capfd):
    chance = random.Random(seed)
    loaded, told = 0, []
    for case in range(CASES):
        text = spoilt(chance.choice(texts), chance)
        for _ in range(chance.randrange(2)):
            text = spoilt(text, chance) if text else text
        options = {"tip": chance.choice(["ee_link", "link06", "x"])} if case % 5 == 0 else {}
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                _, arm, robot = read_robot("<" + text.partition("<")[2], **options)
                check_arm(arm, robot)
                check_shapes(robot)
            loaded += 1
        except hj.HitjointsError as error:
            told.append(str(error))
    assert not any("\n" in line or len(line) > 3000 for line in told)
    assert CASES / 10 < loaded < CASES
    assert capfd.readouterr() == ("", "")
