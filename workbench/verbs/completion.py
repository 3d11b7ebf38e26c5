"""`workbench completion`: a script by which a shell completes verbs, options and studies."""

import argparse

SHELLS = ("bash", "zsh")
FRAME = """{head}_workbench() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} options=""
    if [ "$COMP_CWORD" -eq 1 ]; then
        COMPREPLY=($(compgen -W "{verbs}" -- "$word"))
        return
    fi
    case "${{COMP_WORDS[1]}}" in
{cases}
    esac
    case "$word" in
        -*) COMPREPLY=($(compgen -W "$options" -- "$word")) ;;
        *) COMPREPLY=($(compgen -W "$(ls studies 2> /dev/null)" -- "$word") $(compgen -f -- "$word")) ;;
    esac
}}
complete -o filenames -F _workbench workbench
"""


def declare(verbs) -> None:
    completion = verbs.add_parser(
        "completion",
        help="print a script that lets a shell complete",
        description="Print a script by which bash or zsh completes verbs, options, studies and files: "
        "source <(workbench completion bash).",
    )
    completion.add_argument("shell", choices=SHELLS)
    completion.set_defaults(verbs=verbs)


def do(given: argparse.Namespace) -> int:
    print(_script(given.shell, given.verbs), end="")
    return 0


def _script(shell: str, verbs) -> str:
    """Return the script, made of the words that the command line itself declares. verbs: argparse's action that holds them."""
    words = _options(verbs)
    cases = "\n".join(f'        {verb}) options="{" ".join(known)}" ;;' for verb, known in words.items())
    head = "autoload -Uz bashcompinit && bashcompinit\n" if shell == "zsh" else ""
    return FRAME.format(head=head, verbs=" ".join(words), cases=cases)


def _options(verbs) -> dict[str, list[str]]:
    """Return verb -> its options, as the parser has them."""
    return {
        name: [text for action in one._actions for text in action.option_strings if text.startswith("--")]
        for name, one in verbs.choices.items()
    }
