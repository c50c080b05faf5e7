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

dvec3 place_of(uint corner)
{
    uint at = 6u * indices[corner];
    return dvec3(vertices[at], vertices[at + 1u], vertices[at + 2u]);
}

void add_facet(uint t, inout float normal[3])
{
    precise dvec3 u = place_of(t + 1u) - place_of(t), v = place_of(t + 2u) - place_of(t);
    u = SCALE * u;
    v = SCALE * v;
    precise dvec3 p = u.yzx * v.zxy, q = u.zxy * v.yzx;
    precise dvec3 across = p - q;
    for (int a = 0; a < 3; a++) {
        precise float sum = normal[a] + float(get(across, a));
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
    double size = root_of(square);
    for (int a = 0; a < 3; a++) {
        double unit = quotient(double(normal[a]), size);
        vertices[6u * of.x + 3u + uint(a)] = size > 0.0LF ? float(unit) : a == 2 ? 1.0 : 0.0;
    }
}
