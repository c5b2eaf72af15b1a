"""Commands of docs/reference/clusters.md and clusters/engines.md, with a small run in place of theirs."""

import re

import pytest
from conftest import ROOT, SHORT, flags, needs

RUN = "asperity verify study.toml"


def recipe(engine):
    """Block of commands that starts shards by a program, or by a loop of the shell."""
    pages = [(ROOT / "docs/reference" / name).read_text() for name in ("clusters.md", "clusters/engines.md")]
    blocks = re.findall(r"^```sh\n(.*?)^```", "".join(pages), re.MULTILINE | re.DOTALL)
    (block,) = [block for block in blocks if re.search(rf"^(.*\| )?{engine} .*{RUN}", block, re.MULTILINE)]
    return block.replace(RUN, " ".join(["asperity", *flags(SHORT)]))


@pytest.mark.parametrize("engine", ["for", "parallel", "mpirun"])
def test_recipe_makes_the_results_of_the_run(run, environment, tmp_path, is_whole, engine):
    needs(*{engine} - {"for"})
    # Open MPI does not run as root, nor more processes than cores, unless it is told to
    allowed = dict.fromkeys(["OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "OMPI_MCA_rmaps_base_oversubscribe"], "1")
    run("bash", "-euc", recipe(engine), env={**environment, **allowed})
    is_whole(tmp_path / "results", SHORT)


def test_merging_refuses_missing_unfinished_and_foreign_shards(run):
    """What the page says of them."""
    line = flags(SHORT)
    for k in (1, 2):
        run("asperity", *line, "--shard", f"{k}/3", "-o", f"s{k}", "--quiet")
    run("asperity", *line, "--seed", "2", "--shard", "3/3", "-o", "foreign", "--quiet")
    missing = run("asperity", "merge", "s1", "s2", "-o", "results", check=False)
    assert "1 shard of 3 is missing (3)" in missing
    foreign = run("asperity", "merge", "s1", "s2", "foreign", "-o", "results", check=False)
    assert "foreign cannot be merged" in foreign and "run.seed 2 in place of 1" in foreign
    merged = run("asperity", "merge", "s1", "s2", "-o", "results", "--partial")
    assert "1 shard of 3 is missing (3)" in merged
