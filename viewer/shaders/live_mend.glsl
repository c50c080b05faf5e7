// Gives vertices where the gradient vanishes the sum of the normals of the triangles around them,
// each as long as the triangle's area is large.
layout(local_size_x = 64) in;
layout(std430, binding = 3) readonly buffer Slots
{
    uint slots[];
};
layout(std430, binding = 4) readonly buffer Active
{
    uint active_blocks[];
};
layout(std430, binding = 7) readonly buffer Bases
{
    uvec2 bases[];
};
layout(std430, binding = 11) buffer Vertices
{
    float vertices[];
};
layout(std430, binding = 12) readonly buffer Indices
{
    uint indices[];
};
layout(std430, binding = 14) readonly buffer Missing
{
    uvec4 missing[];
};

void add_facet(uint t, inout float normal[3])
{
    precise double u[3], v[3];
    for (int a = 0; a < 3; a++) {
        double corner = double(vertices[6u * indices[t] + uint(a)]);
        u[a] = double(vertices[6u * indices[t + 1u] + uint(a)]) - corner;
        u[a] = SCALE * u[a];
        v[a] = double(vertices[6u * indices[t + 2u] + uint(a)]) - corner;
        v[a] = SCALE * v[a];
    }
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        precise double p = u[b] * v[c], q = u[c] * v[b];
        precise double across = p - q;
        precise float sum = normal[a] + float(across);
        normal[a] = sum;
    }
}

void main()
{
    uint n = group_number() * 64u + gl_LocalInvocationIndex;
    if (n >= min(totals[MISSING], MEND_CAPACITY))
        return;
    uvec4 of = missing[n];
    ivec3 count = BLOCKS, from = first_sample(active_blocks[of.y]), to = from / 8;
    if (of.z < 1536u) { // the cells around an edge
        int axis = int(of.z >> 9);
        from += ivec3(of.z & 7u, of.z >> 3 & 7u, of.z >> 6 & 7u);
        for (int a = 0; a < 3; a++)
            from[a] -= a == axis ? 0 : 1;
        from = max(from, ivec3(0));
    }
    from /= 8;
    float normal[3] = float[3](0.0, 0.0, 0.0);
    for (int z = from.z; z <= to.z; z++)
        for (int y = from.y; y <= to.y; y++)
            for (int x = from.x; x <= to.x; x++) {
                uint slot = slots[(z * count.y + y) * count.x + x];
                if (slot == NO_SLOT)
                    continue;
                for (uint t = 3u * bases[slot].y; t < 3u * bases[slot + 1u].y; t += 3u)
                    if (indices[t] == of.x || indices[t + 1u] == of.x ||
                        indices[t + 2u] == of.x)
                        add_facet(t, normal);
            }
    precise double square =
        double(normal[0]) * double(normal[0]) + double(normal[1]) * double(normal[1]);
    square = square + double(normal[2]) * double(normal[2]);
    precise double size = sqrt(square);
    for (int a = 0; a < 3; a++) {
        precise double unit = double(normal[a]) / size;
        vertices[6u * of.x + 3u + uint(a)] = size > 0.0LF ? float(unit) : a == 2 ? 1.0 : 0.0;
    }
}
