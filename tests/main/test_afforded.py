"""What the dialogue lists is what the human can do now; what an object contains may afford an action in its place."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from msgspec.structs import replace

from ahmss.algorithm import messages
from ahmss.body.array import Array
from ahmss.database import Workspace
from ahmss.database.check import check
from ahmss.errors import CommandError, DataError
from ahmss.main.afforded import Actor, Meant, meant, why_not
from ahmss.main.catalogue import WorldCatalogue
from ahmss.main.command import Act
from ahmss.main.database import Database
from ahmss.main.enabling import not_enabled
from ahmss.main.listing import list_workspace
from ahmss.main.passing import taking
from ahmss.main.who_reaches import who_reaches
from ahmss.states.condition import parse_condition
from ahmss.world.schema import ObjectRecord

SHIPPED = Workspace(Path(__file__).resolve().parents[2])
KEN = SHIPPED.humans.get("ken").skeleton


class Room:
    """A scene of the shipped room's objects."""

    def __init__(self, workspace: Workspace = SHIPPED, kind: str = "room") -> None:
        self.placed = {one.name: one for one in workspace.objects.place(kind, kind)}
        self.objects = {
            name: ObjectRecord(
                i, name, one.kind, one.position, one.rotation, one.parent,
                states=dict(workspace.objects.get(one.kind).initial_states),
            )
            for i, (name, one) in enumerate(self.placed.items())
        }  # fmt: skip

    def pose(self, name: str) -> Array:
        return np.array((*self.placed[name].position, *self.placed[name].rotation))

    def others(self) -> list[messages.ObjectRecord]:
        return []

    def held(self, name: str, holder: str) -> None:
        self.objects[name] = replace(self.objects[name], holder=holder, hand="right")


def ken(between: frozenset[str] = frozenset(), **holds: str) -> Actor:
    rotations, root = KEN.upright()
    held = {name.replace("__", "/"): hand for name, hand in holds.items()}
    return Actor("ken", KEN, root, rotations, held, between)


def actions(room: Room, name: str, actor: Actor, workspace: Workspace = SHIPPED) -> set[str]:
    return set(WorldCatalogue(workspace, room, lambda: actor).actions(name).names)  # type: ignore[arg-type]


def test_a_cup_in_the_hand_affords_drinking_and_putting_down_but_not_grasping() -> None:
    room = Room()
    free = actions(room, "cup", ken())
    assert {"reach", "grasp"} <= free
    assert not {"drink", "put", "release", "lift"} & free
    room.held("room/cup", "ken")
    taken = actions(room, "cup", ken(room__cup="right"))
    assert {"drink", "put", "release"} <= taken
    assert not {"reach", "grasp"} & taken


def test_what_another_holds_and_what_full_hands_can_not_do_is_no_choice() -> None:
    room = Room()
    room.held("room/cup", "aiko")
    assert not {"reach", "grasp", "drink"} & actions(room, "cup", ken())
    assert "sit" in actions(room, "chair", ken(a="right", b="left"))
    assert "open" not in actions(room, "door", ken(a="right", b="left"))
    assert "open" in actions(room, "door", ken(a="right"))


def test_who_sits_is_told_to_stand_up_from_their_seat_rather_than_raised_in_place() -> None:
    room = Room()
    assert "stand" in actions(room, "floor", ken(room__cup="right"))
    sits = ken(room__chair="")
    assert "stand" not in actions(room, "floor", sits)
    assert "reach" in actions(room, "floor", sits)
    what = meant(SHIPPED, room, "room/floor", "stand")  # type: ignore[arg-type]
    assert why_not(what, sits) == "room/floor stand: one must stand for that; `do room/chair stand_up` first"


def test_a_door_that_is_open_can_only_be_closed() -> None:
    room = Room()
    assert actions(room, "door", ken()) >= {"open"}
    assert "close" not in actions(room, "door", ken())
    room.objects["room/doorway/door"].states["angle"] = 1.3
    assert "open" not in actions(room, "door", ken())
    assert "close" in actions(room, "door", ken())


PANEL = """\
[affordances.press]
of = "button"

[[contains]]
kind = "button"
"""
BUTTON = """\
[states.position]
values = ["out", "in"]

[affordances.press]
human_algorithm = "push"
sentence = "Push it in."
asks = ["hand"]
when = "position == out"
frames = 33
"""


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    for kind, text in (("panel", PANEL), ("button", BUTTON)):
        (tmp_path / "objectdb" / kind).mkdir(parents=True)
        (tmp_path / "objectdb" / kind / "object.toml").write_text(text)
    (tmp_path / "humandb").mkdir()
    push = tmp_path / "algorithms" / "push"
    push.mkdir(parents=True)
    (push / "algorithm.toml").write_text('kind = "human"\nargv = ["python", "push.py"]\n')
    (push / "push.py").write_text("")
    return Workspace(tmp_path)


def test_a_panel_is_pressed_by_its_button(workspace: Workspace) -> None:
    room = Room(workspace, "panel")
    catalogue = WorldCatalogue(workspace, room, ken)  # type: ignore[arg-type]
    assert catalogue.actions("panel").entries == (("press", "Push it in."),)
    assert catalogue.asks("panel", "press") == (("hand",), 33)
    order = Database(workspace).order(Act("panel", "press"), room, ken())
    assert (order.object, order.title, order.hand) == ("panel/button", "panel/button press", "right")
    room.objects["panel/button"].states["position"] = "in"
    assert actions(room, "panel", ken(), workspace) == set()
    with pytest.raises(CommandError, match="panel/button press: only when its position is out; its position is in"):
        Database(workspace).check(order, room, ken())
    del room.objects["panel/button"]
    with pytest.raises(CommandError, match="panel press: its button is not in the world any more"):
        Database(workspace).order(Act("panel", "press"), room, ken())


def test_a_panel_that_names_a_wrong_part_or_action_is_told(workspace: Workspace) -> None:
    file = workspace.root / "objectdb/panel/object.toml"
    file.write_text(PANEL.replace('of = "button"', 'of = "lever"'))
    with pytest.raises(
        DataError, match=r'affordances.press.of \(line 2\): contains no "lever"; this object contains: button'
    ):
        workspace.objects.get("panel")
    file.write_text(PANEL.replace("affordances.press", "affordances.pull"))
    assert check(workspace).problems == (
        'objectdb/panel/object.toml: affordances.pull.of: "button" does not afford it; it affords: press',
    )


def refusal(room: Room, name: str, action: str, actor: Actor) -> str:
    return why_not(meant(SHIPPED, room, f"room/{name}", action), actor)  # type: ignore[arg-type]


def test_a_seat_is_sat_on_and_a_cup_is_held() -> None:
    room = Room()
    assert refusal(room, "chair", "sit", ken(room__chair="")) == "room/chair sit: ken sits on it already"
    assert refusal(room, "chair", "stand_up", ken()) == "room/chair stand_up: ken does not sit on it"
    assert refusal(room, "cup", "grasp", ken(room__cup="left")) == "room/cup grasp: ken holds it already"
    assert refusal(room, "cup", "lift", ken()) == "room/cup lift: ken does not hold it"


def test_who_has_it_and_what_hands_are_full_of_is_said_in_words() -> None:
    room = Room()
    assert refusal(room, "cup", "reach", ken(room__cup="left")) == "room/cup reach: ken holds it already"
    room.held("room/cup", "aiko")
    assert refusal(room, "cup", "reach", ken()) == "room/cup reach: aiko has it"
    full = ken(room__cup="left", a="right")
    assert refusal(room, "cup", "grasp", full) == "room/cup grasp: ken holds it already"
    takes = "room/television/switch press: it takes a free hand, and ken holds room/cup and a; put that down first"
    assert refusal(room, "television/switch", "press", full) == takes


def test_the_hand_that_does_not_hold_it_does_nothing_with_it() -> None:
    room = Room()
    room.held("room/cup", "ken")
    order = Database(SHIPPED).order
    with pytest.raises(CommandError, match=r"cup drink: ken holds it in the right hand; leave out `hand left`"):
        order(Act("cup", "drink", hand="left"), room, ken(room__cup="right"))  # type: ignore[arg-type]
    same = order(Act("cup", "drink", hand="right"), room, ken(room__cup="right"))  # type: ignore[arg-type]
    assert same.hand == "right"


def test_a_hand_that_is_full_uses_nothing_else() -> None:
    """It pressed a switch, and the cup in it hung aslant."""
    order, press = Database(SHIPPED).order, Act("television/switch", "press", hand="right")
    with pytest.raises(CommandError, match=r"ken holds room/cup in the right hand; leave out `hand right`"):
        order(press, Room(), ken(room__cup="right"))  # type: ignore[arg-type]
    assert order(press, Room(), ken(room__cup="left")).hand == "right"  # type: ignore[arg-type]


def test_an_action_that_is_meant_is_named_also_where_it_is_a_part_that_affords_it() -> None:
    room = Room()
    with pytest.raises(CommandError, match=r'room/cup does not afford "grap"; did you mean grasp\?$'):
        meant(SHIPPED, room, "room/cup", "grap")  # type: ignore[arg-type]
    with pytest.raises(CommandError, match=r'room/sink does not afford "turn"; room/sink/tap does, which is in it$'):
        meant(SHIPPED, room, "room/sink", "turn")  # type: ignore[arg-type]
    with pytest.raises(CommandError, match=r'room/cup does not afford "eat"; it affords: reach, grasp, '):
        meant(SHIPPED, room, "room/cup", "eat")  # type: ignore[arg-type]


def test_an_action_without_a_sentence_is_listed_by_that_of_its_algorithm(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for file, text in {
        "objectdb/lamp/object.toml": 'name = "lamp"\n[affordances.greet]\nhuman_algorithm = "bow"\n',
        "algorithms/bow/algorithm.toml": 'kind = "human"\nargv = ["python", "bow.py"]\nsentence = "Bows the head."\n',
        "algorithms/bow/bow.py": "",
    }.items():
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_text(text)
    workspace = Workspace(tmp_path)
    room = Room(workspace, "lamp")
    listing = WorldCatalogue(workspace, room, ken).actions("lamp")  # type: ignore[arg-type]
    assert listing.entries == (("greet", "Bows the head."),)
    list_workspace("lamp", tmp_path, as_json=False)
    assert "greet\tBows the head." in capsys.readouterr().out


def test_a_kind_of_which_there_is_none_is_told_how_to_be_added() -> None:
    with pytest.raises(
        CommandError, match=r'no object "keyboard" in the world; add one: `add keyboard at X Y Z`, in a scene'
    ):
        Database(SHIPPED).order(Act("keyboard", "type"), Room(), ken())  # type: ignore[arg-type]
    with pytest.raises(CommandError, match=r'no object "keybord" in the world; there are: room, '):
        Database(SHIPPED).order(Act("keybord", "type"), Room(), ken())  # type: ignore[arg-type]


def test_what_is_between_both_hands_leaves_none_free() -> None:
    room, carrying = Room(), ken(frozenset({"carton"}), carton="right")
    takes = "room/television/switch press: it takes a free hand, and ken holds carton; put that down first"
    assert refusal(room, "television/switch", "press", carrying) == takes


def test_what_is_carried_between_both_hands_is_not_handed_over_but_put_down_for_who_is_to_have_it() -> None:
    """One hand held it out: it hung in the air."""
    carton = ObjectRecord(1, "carton", "carton", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
    told = "between both hands; `do carton put_down`, and who is to have it does `do carton lift`"
    with pytest.raises(CommandError, match=told):
        taking(SHIPPED, carton)
    assert taking(SHIPPED, replace(carton, name="cup", kind="cup"))[1].name == "grasp"


def test_what_is_not_enabled_names_what_enables_it() -> None:
    room = Room(kind="control_room")
    key, pump = "control_room/key_switch", "control_room/pump"

    def told(button: str) -> list[str]:
        return list(not_enabled(SHIPPED, room.objects, f"control_room/panel/{button}", {"position": "in"}))

    assert told("button_1") == [
        f"{pump} running stays as it is, since {pump} enabled is no; `do key_switch turn position=on` first"
    ]
    assert told("button_2") == told("button_5") == told("button_10") == []  # nothing to stop, or to acknowledge
    assert why_not(meant(SHIPPED, room, key, "turn"), ken()).endswith(f"cover is closed; `do {key} open` first")  # type: ignore[arg-type]
    assert why_not(meant(SHIPPED, room, key, "close"), ken()).endswith(
        "only when its cover is open; its cover is closed"
    )  # type: ignore[arg-type]
    room.objects[pump] = replace(room.objects[pump], states=room.objects[pump].states | {"enabled": "yes"})
    assert told("button_1") == []


def test_what_is_done_elsewhere_names_what_does_it() -> None:
    """A pump is started, and an alarm acknowledged, by a button."""
    room = Room(kind="control_room")
    for name, action, hint in (
        ("pump", "start", "its state start is set by `do button_1 press`"),
        ("pump", "stop", "its state stop is set by `do button_2 press`"),
        ("window_1", "acknowledge", "its state acknowledge is set by `do button_10 press`"),
        ("pump", "explode", "it affords: check, point"),
    ):
        with pytest.raises(CommandError, match=f'does not afford "{action}"; {hint}'):
            meant(SHIPPED, room, f"control_room/{name}", action)  # type: ignore[arg-type]


def test_who_could_is_named_where_something_is_too_high() -> None:
    class Two(Room):
        def body(self, name: str) -> SimpleNamespace:
            return SimpleNamespace(skeleton=SHIPPED.humans.get(name).skeleton)

    room, aiko = Two(), SHIPPED.humans.get("aiko").skeleton
    rotations, root = aiko.upright()
    actor, what = Actor("aiko", aiko, root, rotations, {}), meant(SHIPPED, room, "room/cup", "reach")  # type: ignore[arg-type]
    for name in ("ken", "aiko"):
        room.objects[name] = ObjectRecord(-1, name, "human", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
    for height, ends in ((1.8, "aiko reaches 1.78 m; ken reaches it"), (2.5, "aiko reaches 1.78 m")):
        high = dataclasses.replace(what, pose=np.array([0.0, 0.0, height, 1.0, 0.0, 0.0, 0.0]))
        assert who_reaches(why_not(high, actor), room, high, actor).endswith(ends)  # type: ignore[arg-type]


def test_why_somebody_who_holds_nothing_gives_nothing_is_said_as_a_person_would() -> None:
    """The condition of the file was read out: `only when oneself == no and holds == something`."""
    kind = SHIPPED.objects.get("human")
    record = ObjectRecord(-2, "aiko", "human", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), states={"holds": "nothing"})
    receive = Meant("aiko", record, kind, kind.affordances["receive"], np.zeros(7))
    assert why_not(receive, ken()) == "aiko receive: only when aiko holds something; aiko holds nothing"
    oneself = dataclasses.replace(receive, name="ken")
    assert why_not(oneself, ken()) == "ken receive: one does that to others, not to oneself"


@pytest.mark.parametrize(
    ("when", "why"),
    [
        ("page < 5", "its page is under 5; its page is 5"),
        ("page != 5 and cover == open", "its page is not 5 and its cover is open; its page is 5, its cover is closed"),
        (
            "cover == open or page >= 5.5",
            "its cover is open, or its page is at least 5.5; its cover is closed, its page",
        ),
        ("held == here and cover == open", "ken holds it and its cover is open; nobody holds it, its cover is closed"),
        ("page <= 5 and cover == open", "its cover is open; its cover is closed"),
    ],
)
def test_what_a_condition_lacks_is_said_in_words(when: str, why: str) -> None:
    kind = SHIPPED.objects.get("manual")
    record = ObjectRecord(
        1, "manual", "manual", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), states={"cover": "closed", "page": 5.0}
    )
    affordance = replace(next(iter(kind.affordances.values())), when=parse_condition(when))
    assert why_not(Meant("manual", record, kind, affordance, np.zeros(7)), ken(), "manual leaf").startswith(
        f"manual leaf: only when {why}"
    )
