"""Types into a shell on a pseudo terminal and looks at what it shows: shell.py SHELL COMPLETION.

It runs in an empty folder. COMPLETION is the script of 'cubewright help --completion SHELL', or
the folder share/ that a package installs scripts into."""
import fcntl
import os
import pty
import re
import select
import struct
import sys
import termios
import time

LIMIT_S = 300 * int(os.environ.get('CUBEWRIGHT_TEST_SLOW', '1'))  # for an answer of a shell that does not hang
MOVES = re.compile(r'\x1b\][^\x07\x1b]*(?:\x07|\x1b\\)|\x1b\[[0-9;?>=]*[A-Za-z]|'
                   r'\x1b[()][0-9A-B]|\x1b[=>]|[\x07\x0f\x0e]')

START = {
    'bash': (['bash', '--norc', '--noprofile', '-i'], """
PS1='ready> '
bind 'set enable-bracketed-paste off'
bind 'set bell-style none'
bind 'set page-completions off'
bind 'set completion-query-items 0'
bind 'set show-all-if-ambiguous on'
bind 'set colored-stats off'
cubewright() { printf '<%s>' "$@"; echo; }
"""),
    'zsh': (['zsh', '-f', '-i'], """
PS1='ready> '
unsetopt prompt_sp prompt_cr zle_bracketed_paste 2>/dev/null
unset zle_bracketed_paste
LISTMAX=10000
cubewright() { printf '<%s>' "$@"; echo; }
autoload -Uz compinit
compinit -u -D
"""),
    'fish': (['fish', '--no-config', '-i'], """
function fish_prompt; echo 'ready> '; end
function fish_greeting; end
set -g fish_autosuggestion_enabled 0
function cubewright; printf '<%s>' $argv; echo; end
"""),
}


BASH_COMPLETION = '/usr/share/bash-completion/bash_completion'

# How a shell finds the script in the folder share/, as on a system with the package.
INSTALLED = {
    'bash': '. ' + BASH_COMPLETION + '\n',
    'zsh': 'fpath=(%s/zsh/vendor-completions $fpath)\ncompinit -u -D\n',
    'fish': 'set -p fish_complete_path %s/fish/vendor_completions.d\n',
}


class Shell:
    def __init__(self, name, completion):
        argv, start = START[name]
        self.pid, self.terminal = pty.fork()
        if self.pid == 0:
            env = {k: v for k, v in os.environ.items() if not k.startswith('BASH')}
            home = os.getcwd()
            env.update(TERM='xterm', HOME=home, INPUTRC='/dev/null', LC_ALL='C.UTF-8',
                       XDG_CONFIG_HOME=home + '/.config', XDG_DATA_HOME=home + '/.data',
                       XDG_DATA_DIRS=completion)
            os.execvpe(argv[0], argv, env)
        fcntl.ioctl(self.terminal, termios.TIOCSWINSZ, struct.pack('HHHH', 1000, 200, 0, 0))
        if os.path.isdir(completion):
            start += INSTALLED[name].replace('%s', completion)
        else:
            start += '. ' + completion + '\n'
        with open('.start', 'w') as f:
            f.write(start + 'cubewright begun\n')
        self.type('. ./.start\n')
        self.read(r'<begun>.*ready> ')

    def type(self, text):
        os.write(self.terminal, text.encode())

    def read(self, awaited):
        """Returns what it shows, up to a pattern, without what moves the cursor."""
        shown, end = '', time.monotonic() + LIMIT_S
        while time.monotonic() < end and not re.search(awaited, shown, re.DOTALL):
            if select.select([self.terminal], [], [], 1)[0]:
                shown += os.read(self.terminal, 65536).decode(errors='replace')
                shown = MOVES.sub(' ', shown)
        return shown

    def shows(self, typed):
        """Returns what is shown after a TAB. Ctrl-U removes the line."""
        self.type(typed + '\t\x15cubewright end\n')
        return self.read(r'<end>.*ready> ').split('cubewright end')[0]

    def runs(self, typed):
        """Returns the words that the program is given after a TAB and Enter."""
        self.type(typed + '\t\n')
        shown = self.read(r'>\s*\r?\n.*ready> ')
        found = re.findall(r'((?:<[^<>\n]*>)+)', shown)
        return found[-1] if found else shown

    def end(self):
        os.close(self.terminal)
        os.waitpid(self.pid, 0)


# Typed, and the words that are run after a TAB and Enter.
RUNS = [
    ('cubewright ext', '<extract>'),
    ('cubewright extract --is', '<extract><--iso>'),
    ('cubewright extract --topology fi', '<extract><--topology><field>'),
    ('cubewright extract --topology=fi', '<extract><--topology=field>'),
    ('cubewright extract my', '<extract><my head.nrrd>'),
    ('cubewright extract "my', '<extract><my head.nrrd>'),
    ('cubewright extract sub/', '<extract><sub/in.nii.gz>'),
    ('cubewright simplify sol', '<simplify><solid.stl>'),
    ('cubewright check solid.stl --source my', '<check><solid.stl><--source><my head.nrrd>'),
    ('cubewright check solid.stl --source=my', '<check><solid.stl><--source=my head.nrrd>'),
    ('cubewright extract a.nrrd -o out.st', '<extract><a.nrrd><-o><out.stl>'),
    ('cubewright extract a.nrrd --iso 3 --json rep',
     '<extract><a.nrrd><--iso><3><--json><report.json>'),
    ('cubewright join par', '<join><parts>'),
    ('cubewright make gyr', '<make><gyroid>'),
    ('cubewright render a.nrrd --tf ct-b', '<render><a.nrrd><--tf><ct-bone>'),
    ('cubewright render a.nrrd --camera fro', '<render><a.nrrd><--camera><front>'),
    ('cubewright render a.nrrd -m local', '<render><a.nrrd><-m><local-mip>'),
    ('cubewright extract a.nrrd --no-ope', '<extract><a.nrrd><--no-open>'),
    ('cubewright convert solid.stl --format neuro', '<convert><solid.stl><--format><neuroglancer>'),
    ('cubewright help lib', '<help><library>'),
    ('cubewright help --man simp', '<help><--man><simplify>'),
    ('cubewright extract --labels al', '<extract><--labels><all>'),
    ('cubewright extract notes', '<extract><notes.txt>'),
    ('cubewright extract ~/sub/', '<extract><{HOME}/sub/in.nii.gz>'),
    ('cubewright extract -- my', '<extract><--><my head.nrrd>'),
    ('cubewright extract -qt 2 my', '<extract><-qt><2><my head.nrrd>'),
    ('cubewright info odd/', '<info><odd/it\'s (1) $5 "a" [b].nrrd>'),
    ('cubewright info O', '<info><ODD.NII>'),
    ('cubewright info t:', '<info><t:1.nrrd>'),
    ('cubewright report marsch', '<report><marschner-lobb>'),
    ('cubewright render "my head.nrrd" --save-tf=wind', '<render><my head.nrrd><--save-tf=wind>'),
    ('cubewright make sphere -o x.nii.g', '<make><sphere><-o><x.nii.gz>'),
]

# Typed, then what is seen, and what is not.
SHOWS = [
    ('cubewright ', ['extract', 'simplify', 'version'], ['solid.stl']),
    ('cubewright extract --s', ['--simplify', '--spacing', '--snap'], ['--json']),
    ('cubewright extract --iso ', [], ['solid.stl', 'head.nrrd']),
    ('cubewright extract --topology ', ['field', 'simple'], ['solid.stl']),
    ('cubewright extract ', ['head.nrrd', 'sub/'], ['solid.stl', 'notes.txt']),
    ('cubewright simplify ', ['solid.stl', 'other.ply'], ['head.nrrd', 'notes.txt']),
    ('cubewright extract my\\ head.nrrd -o x.', ['x.obj', 'x.stl', 'x.ply', 'x.3mf'], ['x.nrrd']),
    ('cubewright make sphere -o x.', ['x.nrrd', 'x.nii.gz', 'x.mha'], ['x.stl']),
    ('cubewright join ', ['parts/'], ['notes.txt', 'solid.stl']),
]

# The same in bash, which leaves out what the options on the line exclude.
EXCLUDES = [
    ('cubewright extract --labels all --s', ['--simplify', '--smooth-labels'], ['--snap', '--steps']),
    ('cubewright extract --snap=0.3 --la', [], ['--labels']),
    ('cubewright extract -p print --o', ['--output'], ['--open']),
    ('cubewright extract -p none --o', ['--output', '--open'], []),
    ('cubewright extract --no-check --p', ['--preview', '--profile'], []),
    ('cubewright extract --profile=print --no-c', ['--no-cull'], ['--no-check']),
]


def main():
    name, completion = sys.argv[1:3]
    for folder in ('sub', 'parts', 'odd'):
        os.mkdir(folder)
    for file in ('my head.nrrd', 'sub/in.nii.gz', 'solid.stl', 'other.ply', 'notes.txt',
                 'report.json', 'odd/it\'s (1) $5 "a" [b].nrrd', 't:1.nrrd', 'ODD.NII'):
        open(file, 'w').close()
    shell = Shell(name, completion)
    bad = []
    for typed, words in RUNS:
        if name == 'fish' and ':' in typed:
            continue  # behind a ':' fish offers the files of this folder for every program
        got = shell.runs(typed).replace('/>', '>')  # zsh drops the '/' of a folder
        print(f'{name}: {typed}<TAB> runs {got}')
        if got != words.replace('{HOME}', os.getcwd()):
            bad.append(f'{typed}<TAB> runs {got}, expected {words}')
    for typed, seen, unseen in SHOWS + (EXCLUDES if name == 'bash' else []):
        answer = shell.shows(typed).replace(typed, ' ')
        print(f'{name}: {typed}<TAB> shows {" ".join(answer.split())[:300]}')
        bad += [f'{typed}<TAB> lacks {word}' for word in seen if word not in answer]
        bad += [f'{typed}<TAB> shows {word}' for word in unseen if word in answer]
    shell.shows('cubewright extract "$(touch oops)" `touch oops` my')
    if os.path.exists('oops'):
        bad.append('a TAB ran what stands on the line')
    shell.end()
    print('\n'.join(bad))
    return 1 if bad else 0


sys.exit(main())
