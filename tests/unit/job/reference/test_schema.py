"""The JSON schema accepts what job files may have, and names every key with its meaning."""

import tomllib
from dataclasses import fields

import pytest
from tests.unit.test_docs import ROOT

from amprep.job.loading import KEYS
from amprep.job.reference.page import key_texts
from amprep.job.reference.schema import ENTRIES, SECTIONS, job_schema

SCALARS = {
    "boolean": bool,
    "integer": int,
    "number": (int, float),
    "string": str,
    "object": dict,
    "array": list,
}


def accepts(schema, value):
    """A validator of the few words that the schema uses."""
    if "anyOf" in schema:
        return any(accepts(each, value) for each in schema["anyOf"])
    if "enum" in schema:
        return value in schema["enum"]
    wanted = SCALARS[schema["type"]] if "type" in schema else object
    if not isinstance(value, wanted) or (
        isinstance(value, bool) and schema.get("type") in ("integer", "number")
    ):
        return False
    if schema.get("type") == "object" and "properties" in schema:
        known = schema["properties"]
        return all(key in known and accepts(known[key], each) for key, each in value.items())
    if schema.get("type") == "array":
        items, low, high = schema["items"], schema.get("minItems", 0), schema.get("maxItems", len(value))
        pairs = (
            zip(items, value, strict=False) if isinstance(items, list) else ((items, each) for each in value)
        )
        return low <= len(value) <= high and all(accepts(*each) for each in pairs)
    return True


def test_every_key_is_in_the_schema_with_its_meaning():
    properties = job_schema()["properties"]
    assert set(properties) == set(KEYS)
    for name, cls in {**SECTIONS, **ENTRIES}.items():
        table = properties[name].get("items", properties[name])
        assert set(table["properties"]) == {field.name for field in fields(cls)} == set(key_texts()[name])
        assert all(len(each["description"]) > 10 for each in table["properties"].values())
    assert not any("](" in text.meaning for texts in key_texts().values() for text in texts.values())


def test_the_schema_accepts_the_demo_and_the_job_of_the_page():
    demo = tomllib.loads((ROOT / "fixtures" / "demo" / "job.toml").read_text(encoding="utf-8"))
    page = (ROOT / "docs" / "job-file.md").read_text(encoding="utf-8").split("```toml\n")[1].split("```")[0]
    for job in (demo, tomllib.loads(page)):
        assert accepts(job_schema(), job)


@pytest.mark.parametrize(
    "text",
    [
        "pitch = 1",
        "[packing]\nclearance = 1",
        '[packing]\nclearance_mm = "wide"',
        '[packing]\nobjective = "beauty"',
        "[[part]]\nfixed = [[1.0, 2.0]]",
        "[supports]\nenabled = 1",
    ],
)
def test_the_schema_refuses_what_job_files_must_not_have(text):
    assert not accepts(job_schema(), tomllib.loads(text))
