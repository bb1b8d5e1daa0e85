"""The rows of the verbs: one line each for a heading of sub-commands and for a verb or sub-command in Python, beside
the file that it names. A verb of the program has its line in experiments/cli/verbs.inc.
"""

from typing import NamedTuple

ENVIRONMENT = "environment"  # the Python environment, which ./bench has made
PROGRAM = "program"  # the release build of barrierbench too
HELP = ("-h", "--help")
WITHOUT = (*HELP, "--no-run", "--list")  # with one of these no verb needs a built program
# Modes of a study: the word behind its name, and the option that it stands for.
RUN, PLAN, PAGE, TABLE_PAGE = ("run", ""), ("plan", "--plan"), ("page", "--no-run"), ("page", "--table")
RENAMED = {
    "neutral": "export-scene"
}  # old word of the program -> its name; else the word itself is the old name
# Studies with a spec in configs/studies that were verbs of their own before.
STUDIES_BEFORE = frozenset(
    {"ablation", "catalogue", "gap-map", "pareto", "robust", "stress", "work-precision"}
)


class Heading(NamedTuple):
    """Sub-commands below one name."""

    name: str
    group: str  # one of GROUPS
    help: str
    example: str
    default: str = ""  # the sub-command without one


class Verb(NamedTuple):
    """One row of the table."""

    name: str  # what is typed behind ./bench: a verb, or a heading and a sub-command
    group: str  # one of GROUPS
    needs: str  # ENVIRONMENT, PROGRAM, or a target of the release build
    module: str  # below barrierbench_analysis; empty: a verb of the program, or of the script ./bench itself
    arguments: str
    help: str
    example: str
    was: str = ""  # the name before this one, which still runs it
    modes: tuple[tuple[str, str], ...] = ()  # of RUN, PLAN, PAGE
    without: tuple[str, ...] = ()  # more options with which it needs no built program
    own_help: bool = True  # answers --help itself; else its row does
    word: str = ""  # of a verb of the program: what the program calls it
    subject: str = ""  # of a study of the kit: its name or the path of its spec, before the arguments


# fmt: off
HEADINGS = (
    Heading("study", "study", "what costs how much, and why: a study runs what is missing and writes its page and figures", "./bench study gap-map page"),
    Heading("gate", "judge", "judges this build against results/baselines; without a sub-command as `gate run`", "./bench gate --history history.jsonl", default="run"),
    Heading("draw", "make", "figures of records, stills and players of runs that kept frames", "./bench draw figures results/runs/demo"),
    Heading("data", "make", "meshes, frames, systems, time steps and records in other forms, or measured", "./bench data frames results/runs/drape out/drape --format vtu"),
    Heading("dev", "develop", "tools for changing the code and the pages", "./bench dev format"),
)
TABLE = (
    Verb("demo", "run", PROGRAM, "front.demo", "", "setup, build, the demonstration sweep, its figures and the page that says what they show; ends with a table of what each formulation takes", "./bench demo"),
    Verb("status", "run", ENVIRONMENT, "tables.sweeps.status", "DIR [--watch]", "where the runs of a sweep are: over, running, dead, stopped, unreadable or waiting; 0 when all are over", "./bench status results/runs/demo/demo_strip --watch"),
    Verb("formula", "look", ENVIRONMENT, "program.formula.verb", "TEXT", "a barrier as a formula: whether it is one and where it fails, its derivatives, limits, precision, C++", "./bench formula '-(d - d_hat)^2*log(d/d_hat)'"),
    Verb("scenes", "look", PROGRAM, "studies.catalogue.scenes", "[NAME...]", "the scenes of the catalogue (configs/catalogue): what each stresses, its size as mini and as in its source; --write makes its config", "./bench scenes twist --write twist.json", without=("--write", "--list")),
    Verb("completion", "look", ENVIRONMENT, "front.completion", "bash|zsh", "a script for the shell that completes verbs, sub-commands, options and files", 'eval "$(./bench completion bash)"'),
    Verb("study causes", "study", PROGRAM, "tables.causes", "RUN|CONFIG", "a condition number taken apart: stages, scalings, and where the eigenvectors of both ends live", "./bench study causes configs/scenes/sphere_on_sheet.json --set /time/steps=5", was="causes"),
    Verb("study match", "study", PROGRAM, "studies.matching.match", "CONFIG", "calibrates formulations on one scene, runs each, says which may be compared: 0 all, 1 not all, 2 bad input", "./bench study match configs/scenes/drape2d.json --formulations cubic quadratic", was="match"),
    Verb("study score", "study", PROGRAM, "studies.rules.score.verb", "FORMULA|PLUGIN|NAME", "one page for a new barrier: matched, started from jittered states and put through hard cases beside log, quadratic, cubic and a consistent stiffness (minutes)", "./bench study score '(d_hat - d)^3/d'", was="score"),
    Verb("study claims", "study", PROGRAM, "pages.claims.verb", "[ID...]", "runs what is missing, computes the verdict on every claim from its records: results/CLAIMS.md and .csv, docs/claims.png; --export FILE: as edges of the public graph of claims", "./bench study claims run K3 H1", without=("--plan", "--export"), was="claims", modes=(RUN, PLAN, PAGE)),
    Verb("study matrix-corpus", "study", PROGRAM, "studies.matrices.matrix_corpus", "[--table]", "the hard systems of results/matrices from configs/matrices/corpus.json, and their table", "./bench study matrix-corpus --table", was="matrix-corpus", modes=(RUN, TABLE_PAGE)),
    Verb("study step-corpus", "study", PROGRAM, "studies.steps.step_corpus", "[--make | --take | --table]", "the hard time steps of results/steps from configs/steps/corpus.json, each by every step solver and Hessian: results/STEPS.md, docs/steps.png", "./bench study step-corpus --table", was="step-corpus", modes=(RUN, TABLE_PAGE)),
    Verb("study condition-table", "study", PROGRAM, "studies.matrices.condition_table", "", "results/CONDITION.md: what Spectra and our Lanczos take for the condition numbers of the demo and of results/matrices, and how far they differ", "./bench study condition-table", was="condition-table", modes=(RUN,)),
    Verb("study gpu-report", "study", ENVIRONMENT, "studies.device.gpu_report", "", "results/GPU.md and its figure from the records of cards that experiments/gpu_evidence.sh made", "./bench study gpu-report", was="gpu-report", modes=(("page", ""),)),
    Verb("study compare-toolkit", "study", "contact_stages", "studies.toolkit.compare_toolkit", "", "our stages of contact beside those of the IPC Toolkit, in turn: a table of ratios", "./bench study compare-toolkit --mesh sheets --rounds 3", was="compare-toolkit", modes=(RUN,)),
    Verb("judge", "judge", PROGRAM, "studies.judge.verb", "TRAJECTORY", "the frames of any program before our exact audit: crossings, passages, depths, gaps, stretch, volumes: judgement.json and .html; 0 clean, 1 not", "./bench judge out/frames --about scene.json"),
    Verb("engine", "judge", PROGRAM, "studies.engines.verb", "list | NAME setup | NAME run SCENE --out DIR | compare [SPEC] | [NAME] cases", "scenes under engines of others (engines/NAME), each judged as ./bench judge does, beside ours: results/ENGINES.md, docs/engines.png; cases of public trackers: results/ENGINES_CASES.md", "./bench engine list", without=("list", "setup")),
    Verb("verify", "judge", ENVIRONMENT, "studies.archives.verify", "STUDY [--rerun N]", "records held against their files: what is missing, extra or edited; makes N runs again and compares their bits; 0 nothing wrong, 1 something, or nothing judged", "./bench verify results/runs/demo/demo_strip --rerun 2"),
    Verb("gate run", "judge", PROGRAM, "studies.gate.gate", "[--set SET]", "runs a small set of cases and judges them against results/baselines; or another solver's matrices", "./bench gate run --matrix dumps/*.mtx --baseline conditioning.json", without=("--matrix", "--record")),
    Verb("gate compare", "judge", ENVIRONMENT, "studies.gate.compare", "A B", "two records, or folders of them: which numbers differ, in which direction, 0 same, 1 regressed, 2 cannot compare", "./bench gate compare results/runs/before results/runs/after", was="compare"),
    Verb("gate calibrate", "judge", PROGRAM, "studies.gate.calibrate", "", "measures envelopes for the gate by 20 perturbed copies a case", "./bench gate calibrate", without=("--matrix", "--record"), was="calibrate"),
    Verb("gate accept", "judge", ENVIRONMENT, "studies.gate.accept", "--reason TEXT", "keeps the envelopes that were measured last as baselines, with a reason", './bench gate accept --reason "the contact Hessian is exact"', was="accept"),
    Verb("gate trend", "judge", ENVIRONMENT, "studies.gate.trend", "FILE", "steps in the numbers that ./bench gate --history FILE has kept, run after run; never a failure", "./bench gate trend history.jsonl", was="trend"),
    Verb("report", "make", ENVIRONMENT, "pages.report.verb", "DIR [DIR2]", "one HTML page, which needs no network, of the records below a folder: answer, verdict, players, failures, comparison, figures, every run with its command, methods; of two folders what differs", "./bench report results/runs/demo"),
    Verb("import-scene", "make", PROGRAM, "program.imports.verb", "SOURCE --out SCENE.json", "a scene of PolyFEM, libuipc or the ppf contact solver as a config, with a card: what maps, what was changed, what does not map", "./bench import-scene scene.json --out imported/scene.json"),
    Verb("data collect", "make", ENVIRONMENT, "tables.sweeps.collect", "DIR OUT.csv", "the records of a sweep as one tidy table, CSV and Parquet, units in its column names, and a dictionary of its columns", "./bench data collect results/runs/demo/demo_strip strip.csv", was="collect"),
    Verb("data film", "make", ENVIRONMENT, "figures.frames_out.film", "SOURCE OUT", "frames of any program (a folder, PVD, PC2, MDD, NPZ, USD, Alembic, VTKHDF), or of a run, as the numbered files that a config's `film` or `rest_film` names", "./bench data film dance.pc2 out/dance --frame-s 0.041666667", was="film"),
    Verb("data frames", "make", ENVIRONMENT, "figures.frames_out.verb", "RUN OUT --format obj|ply|pc2|vtu|npz|usd|abc", "the frames of a run (--set /output/frames_every=1) as files for other tools; a finer mesh that follows a body (--render-mesh, --subdivide)", "./bench data frames results/runs/drape out/drape --format vtu", was="frames"),
    Verb("data surface-gaps", "make", ENVIRONMENT, "tables.surface_gaps", "RUNS...", "how close the whole surface came to obstacles and to itself in each run; 1 when an ok run entered something", "./bench data surface-gaps results/runs/demo results/runs/claims", was="surface-gaps"),
    Verb("data archive", "make", ENVIRONMENT, "studies.archives.archive_verb", "FOLDER FILE.zip", "a study as one file: its records and all that lies beside them, with a hash of each; gate compare, report, draw figures, data collect and verify read it in the place of the folder", "./bench data archive results/runs/demo/demo_strip strip.zip", was="archive"),
    Verb("data mesh", "make", PROGRAM, "program.mesh_file", "IN OUT.ply", "a mesh of Gmsh (MSH 2.2, 4.1), VTK (VTU, VTP, VTM, VTKHDF, legacy), USD, Alembic or another program, tetrahedra too, as PLY; tetrahedra within a closed surface", "./bench data mesh gear.msh gear.ply", was="mesh"),
    Verb("draw figures", "make", ENVIRONMENT, "figures.plots.verb", "RUNS [OUT]", "figures and table of the records below a folder, or of the file of ./bench data steps --out", "./bench draw figures results/runs/demo", was="figures"),
    Verb("draw still", "make", ENVIRONMENT, "figures.pictures.render", "RUN", "a still (PNG) of one step of a run that kept frames (--set /output/frames_every=1)", "./bench draw still results/runs/drape --color gap", was="render"),
    Verb("draw sheet", "make", ENVIRONMENT, "figures.pictures.stills", "RUN... --out FILE.png", "the last frames of several runs in one picture, each under its label and outcome", "./bench draw sheet results/runs/baseline_stills/* --columns 9 --out docs/baselines.png", was="stills"),
    Verb("draw player", "make", ENVIRONMENT, "pages.play.verb", "RUN [RUN2]", "one HTML file, which needs no network, that plays a run that kept frames (--set /output/frames_every=1), or two side by side", "./bench draw player results/runs/drape-log results/runs/drape-cubic --color gap", was="play"),
    Verb("draw figure", "make", PROGRAM, "studies.comparison.rebuild", "NAME... [--quick]", "a figure of the comparison, rebuilt byte for byte from its spec configs/figures/NAME.json: PNG, PDF, SVG, numbers, caption", "./bench draw figure work_precision --quick", was="figure"),
    Verb("draw pictures", "make", PROGRAM, "figures.pictures.pictures", "", "the stills at the top of README, docs/picture_*.png, from runs of seconds", "./bench draw pictures", was="pictures"),
    Verb("setup", "develop", ENVIRONMENT, "", "", "packages, compiler cache, Python environment; instant when all is there", "./bench setup", own_help=False),
    Verb("build", "develop", ENVIRONMENT, "front.tools", "[PRESET]", "configures and builds (release by default; dev, sanitize, cuda-compile)", "./bench build sanitize", own_help=False, subject="build"),
    Verb("test", "develop", ENVIRONMENT, "front.test", "[--sanitize] [--browser] [CTEST ARGUMENTS]", "setup, build, format check, C++ tests, Python tests, the gate; --browser installs chromium first, so that the player is tested in it", "./bench test -L eval", own_help=False),
    Verb("dev readme", "develop", PROGRAM, "pages.readme.verb", "--check | --write | --fill | --reference", "runs or parses every snippet of README.md and docs; fills the numbers of README.md and docs/results from the records of the demo, or from those that are kept; writes docs/reference from what the program prints", "./bench dev readme --check", was="readme"),
    Verb("dev format", "develop", ENVIRONMENT, "front.tools", "", "clang-format every C++ file and ruff every Python file of analysis/ and python/, in place", "./bench dev format", own_help=False, was="format", subject="dev format"),
    Verb("dev tidy", "develop", ENVIRONMENT, "front.tools", "[FILES]", "clang-tidy the sources (all, or the files named)", "./bench dev tidy core/base/record/hash.cpp", own_help=False, was="tidy", subject="dev tidy"),
    Verb("dev modules", "develop", ENVIRONMENT, "front.tools", "", "the modules of the code, what each one includes, lowest first; fails on a circle or an undeclared one", "./bench dev modules", own_help=False, was="rooms", subject="dev modules"),
    Verb("dev python", "develop", ENVIRONMENT, "front.python_module", "[--no-tests] [PYTEST ARGUMENTS]", "builds the Python module barrierbench beside the program and runs its tests (docs/guides/python.md); pip install . builds it by itself", "./bench dev python --no-tests", own_help=False, was="python"),
    Verb("dev site", "develop", ENVIRONMENT, "front.site", "", "the web site of README.md, docs and results with search and formulas, in build/site; a broken link fails", "./bench dev site"),
    Verb("dev mutate", "develop", ENVIRONMENT, "front.tools", "", "puts mistakes into the code one at a time and counts those that the tests catch", "./bench dev mutate --only 'newton/armijo*'", was="mutate", subject="dev mutate"),
    Verb("dev fuzz", "develop", ENVIRONMENT, "front.fuzz", "[TARGET...]", "feeds broken input to every reader under clang's sanitizers; 1 when one of them fails", "./bench dev fuzz mesh_ply config --seconds 60", was="fuzz"),
    Verb("dev microbenchmarks", "develop", "barrierbench_microbenchmarks", "front.tools", "[GOOGLE BENCHMARK ARGUMENTS]", "ns per shape, query, contact, element, tier; JSON kept in results/runs/microbenchmarks", "./bench dev microbenchmarks --benchmark_filter='drape/.*:48'", own_help=False, was="microbenchmarks", subject="dev microbenchmarks"),
)
# fmt: on
