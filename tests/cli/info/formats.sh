cubewright formats
cubewright formats --json | grep -c '"name"'
cubewright version --features | tail -1
cubewright version --features | grep -c -x -e 'window  *yes' -e 'window  *no: .*'
