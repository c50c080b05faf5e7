# The recipe for Dask: its workers make the parts of a surface; 77 where it is not installed.
# Usage: sh dask.sh BIN_FOLDER
set -eu
PATH=$1:$PATH
/usr/bin/python3 -c 'import distributed' 2>/dev/null ||
    { echo "no dask.distributed (Debian: python3-distributed)"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
HOME=$folder
export HOME
cubewright make gyroid -o ct.nrrd --dims 60 --type i16 --noise 0.2 -q
cubewright extract ct.nrrd --iso 100 -o whole.ply --name bone --stream never -q
cat >parts.py <<'END'
import subprocess
from dask.distributed import Client

def make_part(k, n):
    subprocess.run(["cubewright", "extract", "ct.nrrd", "--iso", "100",
                    "--part", f"{k}/{n}", "--manifest", "parts", "-q"], check=True)

if __name__ == "__main__":
    client = Client(n_workers=2, threads_per_worker=1, dashboard_address=None)
    client.gather(client.map(make_part, range(1, 9), n=8))
    client.close()
END
/usr/bin/python3 parts.py 2>dask.log || { cat dask.log; exit 1; }
cubewright join parts -o bone.ply
cmp whole.ply bone.ply
echo "Dask: the same bytes"
