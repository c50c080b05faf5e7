# What a command does not use it does not load: C++ stays in modules.
ldd "$(command -v cubewright)" | grep -c -e 'stdc++' -e tinygltf
cubewright make sphere -o s.nrrd --dims 16 -q
LD_DEBUG=files LD_DEBUG_OUTPUT=plain cubewright extract s.nrrd --iso 0 -o s.stl -q
grep -l -s 'calling init.*tinygltf' plain* && echo "STL loads tinygltf"
LD_DEBUG=files LD_DEBUG_OUTPUT=glb cubewright extract s.nrrd --iso 0 -o s.glb -q
grep -q 'calling init.*tinygltf' glb* && echo "GLB loads tinygltf"
