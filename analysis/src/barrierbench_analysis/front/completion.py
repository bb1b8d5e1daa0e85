"""A script for the shell that completes verbs, sub-commands, modes of a study, the options that a help names,
and files. For bash: eval "$(./bench completion bash)"; for zsh: eval "$(./bench completion zsh)".
"""

from barrierbench_analysis.io.errors import reported
from barrierbench_analysis.program import verbs
from barrierbench_analysis.program.arguments import parser_of
from barrierbench_analysis.program.verb_table import HEADINGS, Heading

OPTIONS = r"""grep -oE -- '(^|[ ,[])--[a-z][a-z-]*' | grep -oE -- '--.*' | sort -u"""
BASH = """\
_bench() {
  local word="${COMP_WORDS[COMP_CWORD]}" at="$COMP_CWORD" more=""
  local -a name=("${COMP_WORDS[1]}")
  case "$at:${COMP_WORDS[1]}" in
    1:*) more="@TOP@" ;;
@HEADINGS@
  esac
  case "$at:${COMP_WORDS[1]} ${COMP_WORDS[2]}" in
@MODES@
  esac
  case "${COMP_WORDS[1]}" in
    @NAMES@) [ "$at" -le 2 ] || name+=("${COMP_WORDS[2]}") ;;
  esac
@DEFAULTS@
  if [[ "$word" == -* ]]; then
    COMPREPLY=($(compgen -W "$("${COMP_WORDS[0]}" "${name[@]}" --help 2>/dev/null | @OPTIONS@)" -- "$word"))
  elif [ -n "$more" ] && [ "$at" -le 2 ]; then
    COMPREPLY=($(compgen -W "$more" -- "$word"))
  else
    COMPREPLY=($(compgen -W "$more" -- "$word"; compgen -f -- "$word"))
  fi
}
complete -o filenames -F _bench bench ./bench
"""
ZSH = """\
_bench() {
  local -a rows name
  name=($words[2])
  case "$CURRENT:$words[2]" in
    2:*) rows=(
@ROWS@
    ) ;;
@HEADINGS@
  esac
  case "$CURRENT:$words[2] $words[3]" in
@MODES@
  esac
  case "$words[2]" in
    @NAMES@) (( CURRENT <= 3 )) || name+=($words[3]) ;;
  esac
@DEFAULTS@
  if [[ "$PREFIX" == -* ]]; then
    compadd -- ${(f)"$($words[1] $name --help 2>/dev/null | @OPTIONS@)"}
  else
    (( $#rows )) && _describe 'verb' rows
    (( CURRENT > 3 || ( CURRENT == 3 && ! $#rows ) )) && _files
  fi
}
compdef _bench bench ./bench
"""


def _last(verb: verbs.Verb) -> str:
    return verb.name.split()[-1]


def _modes(verb: verbs.Verb) -> list[str]:
    return [name for name, _ in verb.modes]


def _row(row: verbs.Verb | Heading) -> str:
    """Of zsh: the last word of a name, and what it is for."""
    meaning = row.help.replace("'", "").replace(":", r"\:")
    return f"      '{row.name.split()[-1]}:{meaning}'"


def _defaults() -> str:
    """Options behind a heading alone are those of its default."""
    return "\n".join(
        f'  [[ "${{name[*]}}" != {row.name} ]] || name+=({row.default})' for row in HEADINGS if row.default
    )


def _filled(text: str, first: int, parts: dict[str, str]) -> str:
    """first: the number that the shell gives to the word behind ./bench."""
    studies = [verb for verb in verbs.every() if verb.modes]
    modes = (f'    "{first + 2}:{verb.name}") {parts["MODE"](_modes(verb))} ;;' for verb in studies)
    names = "|".join(row.name for row in HEADINGS)
    parts = {"MODES": "\n".join(modes), "NAMES": names, "DEFAULTS": _defaults(), "OPTIONS": OPTIONS, **parts}
    for name, value in parts.items():
        if isinstance(value, str):
            text = text.replace(f"@{name}@", value)
    return text


def script(shell: str) -> str:
    top = verbs.top()
    if shell == "bash":
        headings = (
            f'    2:{row.name}) more="{" ".join(map(_last, verbs.below(row)))}" ;;' for row in HEADINGS
        )
        names = " ".join(sorted(row.name for row in top))
        modes = {"MODE": lambda words: f'more="{" ".join(words)}"'}
        return _filled(BASH, 1, {"TOP": names, "HEADINGS": "\n".join(headings), **modes})
    below = ("\n".join(map(_row, verbs.below(row))) for row in HEADINGS)
    headings = (f"    3:{row.name}) rows=(\n{rows}\n    ) ;;" for row, rows in zip(HEADINGS, below))
    modes = {"MODE": lambda words: f"rows=({' '.join(words)})"}
    return _filled(ZSH, 2, {"ROWS": "\n".join(map(_row, top)), "HEADINGS": "\n".join(headings), **modes})


@reported("completion")
def main(argv: list[str]) -> int:
    parser = parser_of("completion", __doc__)
    parser.add_argument("shell", choices=("bash", "zsh"), metavar="bash|zsh")
    print(script(parser.parse_args(argv).shell), end="")
    return 0
