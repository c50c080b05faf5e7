// Colours a sheet of splats, seen through: it absorbs by its depth, and shines by the mean of
// the colours in it. IN_PLANE: its depths are per voxel that a ray rises across it.
uniform sampler2D sheet;
uniform int axis; // that sheets are across
out vec4 result;

// Returns the way through a voxel's thickness.
float way_across()
{
    vec2 at = (2.0 * gl_FragCoord.xy / picture.xy - 1.0) * picture.zw;
    vec3 direction = view.x > 0.5 ? normalize(vec3(at, -1.0)) : vec3(0.0, 0.0, -1.0);
    vec3 row = vec3(index_from_eye[0][axis], index_from_eye[1][axis], index_from_eye[2][axis]);
    return 1.0 / max(abs(dot(row, direction)), 1e-6);
}

void main()
{
    vec4 sum = texelFetch(sheet, ivec2(gl_FragCoord.xy), 0);
    if (!(sum.a > 0.0))
        discard;
#ifdef IN_PLANE
    float alpha = 1.0 - exp(-sum.a * way_across());
#else
    float alpha = 1.0 - exp(-sum.a);
#endif
    result = vec4(sum.rgb * (alpha / sum.a), alpha);
}
