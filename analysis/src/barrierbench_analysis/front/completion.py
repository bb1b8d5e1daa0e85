"""A script for the shell that completes verbs, the options that the help of a verb names, and files.
For bash: eval "$(./bench completion bash)"; for zsh: eval "$(./bench completion zsh)".
"""

from __future__ import annotations

from barrierbench_analysis.io.errors import tells
from barrierbench_analysis.program import verbs
from barrierbench_analysis.program.arguments import parser_of

OPTIONS = r"""grep -oE -- '(^|[ ,[])--[a-z][a-z-]*' | grep -oE -- '--.*' | sort -u"""
BASH = """\
_bench() {
  local word="${COMP_WORDS[COMP_CWORD]}" verb="${COMP_WORDS[1]}"
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "@VERBS@" -- "$word"))
  elif [[ "$word" == -* ]]; then
    COMPREPLY=($(compgen -W "$("${COMP_WORDS[0]}" "$verb" --help 2>/dev/null | @OPTIONS@)" -- "$word"))
  else
    COMPREPLY=($(compgen -f -- "$word"))
  fi
}
complete -o filenames -F _bench bench ./bench
"""
ZSH = """\
_bench() {
  if (( CURRENT == 2 )); then
    local -a verbs=(
@ROWS@
    )
    _describe 'verb' verbs
  elif [[ "$PREFIX" == -* ]]; then
    compadd -- ${(f)"$($words[1] $words[2] --help 2>/dev/null | @OPTIONS@)"}
  else
    _files
  fi
}
compdef _bench bench ./bench
"""


def _row(verb: verbs.Verb) -> str:
    meaning = verb.help.replace("'", "").replace(":", r"\:")
    return f"      '{verb.name}:{meaning}'"


def script(shell: str) -> str:
    every = verbs.every()
    if shell == "bash":
        names = " ".join(sorted(verb.name for verb in every))
        return BASH.replace("@VERBS@", names).replace("@OPTIONS@", OPTIONS)
    return ZSH.replace("@ROWS@", "\n".join(map(_row, every))).replace("@OPTIONS@", OPTIONS)


@tells("completion")
def main(argv: list[str]) -> int:
    parser = parser_of("completion", __doc__, 'eval "$(./bench completion bash)"')
    parser.add_argument("shell", choices=("bash", "zsh"), metavar="bash|zsh")
    print(script(parser.parse_args(argv).shell), end="")
    return 0
