cubewright formats
cubewright formats --json | grep -c '"name"'
cubewright version --features | tail -1
