"""Whatever a job file or an option says, it is a job or a `JobError` of one line."""

import contextlib

from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.errors import JobError
from amprep.job import apply_sets, job_from_inputs, make_job
from amprep.job.loading import KEYS

SCALARS = (
    st.booleans()
    | st.integers()
    | st.integers(0, 3)
    | st.floats()
    | st.text(max_size=8)
    | st.sampled_from(
        ["EOS M290", "none", "z90", "[[1]]", "a.stl", "builds", "x.stl:3", "\0", "/", "..", "~"]
    )
)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
)
WORDS = [
    "strategy",
    "params",
    "size_mm",
    "shape",
    "zones",
    "name",
    "file",
    "quantity",
    "rotations",
    "boxes",
    "pitch_mm",
    "stacking",
    "readers",
]
SECTIONS = st.dictionaries(st.sampled_from(WORDS), VALUES, max_size=3)
TABLES = st.dictionaries(
    st.sampled_from([*KEYS, "sed"]), VALUES | SECTIONS | st.lists(SECTIONS, max_size=2), max_size=4
)


@given(TABLES)
@examples(100)
def test_any_table_is_a_job_or_a_job_error(table):
    with contextlib.suppress(JobError):
        job = make_job({"inputs": ["a.stl"], **table}, name="x", folder=None, source="x.toml")
        assert job.inputs


@given(
    st.text(max_size=30) | st.tuples(st.sampled_from(["seed", "supports.pitch_mm"]), st.text()).map("=".join)
)
@examples(100)
def test_any_set_is_a_job_or_a_job_error(text):
    with contextlib.suppress(JobError):
        apply_sets(job_from_inputs(["a.stl"]), [text])


@given(st.lists(st.text(max_size=10), max_size=3))
@examples(60)
def test_any_inputs_are_a_job_or_a_job_error(inputs):
    with contextlib.suppress(JobError):
        job_from_inputs(inputs)
