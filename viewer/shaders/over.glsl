// Draws blended slices over the picture so far.
uniform sampler2D slices;
out vec4 result;

void main()
{
    result = texelFetch(slices, ivec2(gl_FragCoord.xy), 0);
}
