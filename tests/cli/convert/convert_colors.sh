# Names and colours of parts, vertices and faces, from file to file.
box() { # $1 x of the box
    for z in 0 30; do for y in 0 20; do for x in $1 $(($1 + 10)); do echo "v $x $y $z"; done; done; done
}
faces() { # $1 first vertex
    for f in "0 2 3 1" "4 5 7 6" "0 1 5 4" "2 6 7 3" "0 4 6 2" "1 3 7 5"; do
        set -- $1 $f
        echo "f $(($1 + $2)) $(($1 + $3)) $(($1 + $4)) $(($1 + $5))"
    done
}
printf 'newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\nmap_Kd wood.png\n' >two.mtl
{ echo mtllib two.mtl; echo o liver; echo usemtl red; box 0; faces 1; } >two.obj
{ echo o spleen; echo usemtl blue; box 50; faces 9; } >>two.obj
materials() { # of a GLB
    tr '{' '\n' <$1 | grep -a -o -e '"name":"[a-z]*"' -e '"baseColorFactor":[^]]*' | sort -u
}

# parts keep names and colours through every command
cubewright convert two.obj -o two.glb -q
materials two.glb | tee expected
for command in 'simplify --ratio 0.9' 'smooth --iterations 1' 'remesh --edge 8mm' repair 'convert --cut-plane z=5mm'; do
    set -- $command
    name=$1
    shift
    cubewright $name two.glb "$@" -o $name.glb -q
    materials $name.glb | cmp - expected && echo "$name keeps them"
done

# faces of a closed surface keep theirs
{ echo mtllib two.mtl; box 0; echo usemtl red; faces 1 | head -n 2; echo usemtl blue; faces 1 | tail -n 4; } >faces.obj
cubewright convert faces.obj -o faces.ply --ascii
grep -A 4 '^element face' faces.ply
grep '^3 ' faces.ply >expected
for format in off 3mf vtp obj glb gltf; do
    cubewright convert faces.ply -o again.$format -q
    cubewright convert again.$format -o again.ply --ascii -q
    grep '^3 ' again.ply | cmp - expected && echo "$format keeps them"
done
cubewright convert faces.ply -o faces.stl

# colours of vertices, and dark ones in glTF
printf 'v 0 0 0 1 0.502 0\nv 1 0 0 0.0314 0.0392 0.0549\nv 0 1 0 0 0 1\nf 1 2 3\n' >dark.obj
cubewright convert dark.obj -o dark.glb -q
cubewright convert dark.glb -o dark.ply --ascii -q
tail -n 4 dark.ply
