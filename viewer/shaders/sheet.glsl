// Colours a sheet of splats, seen through: it absorbs by its depth, and shines by the mean of
// the colours in it.
uniform sampler2D sheet;
out vec4 result;

void main()
{
    vec4 sum = texelFetch(sheet, ivec2(gl_FragCoord.xy), 0);
    if (!(sum.a > 0.0))
        discard;
    float alpha = 1.0 - exp(-sum.a);
    result = vec4(sum.rgb * (alpha / sum.a), alpha);
}
