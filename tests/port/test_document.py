"""The page on the port names every message and every field that there is."""

from __future__ import annotations

import re
import typing
from pathlib import Path

import msgspec
import pytest

from ahmss.port import schema

PAGE = (Path(__file__).parents[2] / "docs" / "human-model-port.md").read_text()
INNER = {
    "do": (schema.Act,), "objects": (schema.Thing, schema.Person), "affordances": (schema.Action, schema.Unavailable),
    "result": (schema.Part,), "events": (schema.Event,),
}  # fmt: skip


@pytest.mark.parametrize("message", [*typing.get_args(schema.Request), *typing.get_args(schema.Reply)])
def test_each_message_has_its_row_with_all_its_fields(message: type[msgspec.Struct]) -> None:
    tag = str(message.__struct_config__.tag)
    rows = [row for row in PAGE.splitlines() if row.startswith(f"| `{tag}` |")]
    assert rows
    told = set(re.findall(r"`(\w+)`", " ".join(rows)))
    fields = {field for field in message.__struct_fields__ if field != "request"}
    for inner in INNER.get(tag, ()):
        if inner is not schema.Act:
            fields |= set(inner.__struct_fields__)
    assert fields <= told


def test_each_field_of_an_act_is_explained() -> None:
    table = PAGE.split("An act of `do`")[1].split("| answer |")[0]
    assert set(schema.Act.__struct_fields__) <= set(re.findall(r"`(\w+)`", table))


def test_the_numbers_of_the_page_are_those_of_the_program() -> None:
    assert f"at most {schema.PAGE}" in PAGE
    assert f"--port {schema.PORT}" in PAGE
    assert f"The version is {schema.VERSION}." in PAGE
    assert f"{schema.LARGEST // 1024} kB" in PAGE
