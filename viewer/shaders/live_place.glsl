// Numbers and stores vertices: those on crossed edges by the block in which their edge begins.
layout(std430, binding = 3) readonly buffer Slots
{
    uint slots[];
};
layout(std430, binding = 4) readonly buffer Active
{
    uint active_blocks[];
};
layout(std430, binding = 5) readonly buffer Records
{
    uint records[];
};
layout(std430, binding = 7) readonly buffer Bases
{
    uvec2 bases[];
};
layout(std430, binding = 9) buffer OpenCells
{
    uvec4 open_cells[]; // block and cell, plan, first triangle, first vertex inside
};
layout(std430, binding = 11) writeonly buffer Vertices
{
    float vertices[]; // position and normal, six a vertex
};
layout(std430, binding = 12) writeonly buffer Indices
{
    uint indices[];
};
layout(std430, binding = 13) readonly buffer Tables
{
    uint tables[];
};
layout(std430, binding = 14) writeonly buffer Missing
{
    uvec4 missing[]; // vertex, block, edge
};

const double NUDGE = 1.0LF / 1024.0LF;

// Finds which of the eight blocks from `slot` on are listed.
void find_slots(uint slot, out uint near[8])
{
    ivec3 n = BLOCKS, at = first_sample(active_blocks[slot]) / 8;
    for (int c = 0; c < 8; c++) {
        ivec3 b = at + ivec3(c & 1, c >> 1 & 1, c >> 2);
        near[c] = all(lessThan(b, n)) ? slots[(b.z * n.y + b.y) * n.x + b.x] : NO_SLOT;
    }
}

// The number of the vertex on the edge along an axis from a sample of a block, or of one after it.
uint vertex_on(uint near[8], int axis, ivec3 sample_at)
{
    ivec3 next = sample_at >> 3, in_block = sample_at & 7;
    uint slot = near[next.x | next.y << 1 | next.z << 2];
    uint s = uint(in_block.x | in_block.y << 3 | in_block.z << 6);
    uint word = uint(axis) * 16u + (s >> 5), at = slot * RECORD;
    uint rank = records[at + RANKS + (word >> 1)] >> (16u * (word & 1u)) & 0xffffu;
    uint before = records[at + word] & ((1u << (s & 31u)) - 1u);
    return bases[slot].x + rank + uint(bitCount(before));
}

// Edge e of a cell begins at this corner.
ivec3 edge_begin(int e)
{
    int low = e & 1, high = e >> 1 & 1;
    return e < 4 ? ivec3(0, low, high) : e < 8 ? ivec3(low, 0, high) : ivec3(low, high, 0);
}

uint cell_vertex(uint near[8], ivec3 cell, int e)
{
    return vertex_on(near, e >> 2, cell + edge_begin(e));
}

uint config_edge(uint config, uint n)
{
    return tables[256u + 8u * config + 4u + n / 8u] >> (4u * (n % 8u)) & 15u;
}

// ---- places ----------------------------------------------------------------------------------

double off_ends(double t)
{
    t = t > NUDGE ? t : NUDGE;
    return t > 1.0LF - NUDGE ? 1.0LF - NUDGE : t;
}

double edge_crossing(bool has_a, uint a, bool has_b, uint b)
{
    if (!has_a || !has_b)
        return !has_a ? 1.0LF - NUDGE : NUDGE;
    bool inf_a = !is_finite(a), inf_b = !is_finite(b);
    if (inf_a || inf_b)
        return off_ends(inf_a && inf_b ? 0.5LF : inf_b ? 0.0LF : 1.0LF);
    precise double half_a = number_of(a) * 0.5LF, half_b = number_of(b) * 0.5LF;
    precise double above = LEVEL * 0.5LF - half_a, step = half_b - half_a;
    return off_ends(quotient(above, step));
}

// Cell coordinates from a padded sample.
void store_position(uint n, ivec3 at, dvec3 x)
{
    precise dvec3 p = dvec3(at - 1) - dvec3(CENTER(0), CENTER(1), CENTER(2));
    p = p + x;
    for (int r = 0; r < 3; r++) {
        precise double sum = AFFINE(r, 0) * p.x + AFFINE(r, 1) * p.y;
        sum = sum + AFFINE(r, 2) * p.z;
        sum = sum + 0.0LF;
        vertices[6u * n + uint(r)] = float(sum);
    }
}

void store_normal(uint n, vec3 normal)
{
    for (int r = 0; r < 3; r++)
        vertices[6u * n + 3u + uint(r)] = normal[r];
}

bool normalise(inout dvec3 d)
{
    double largest = max(max(abs(d.x), abs(d.y)), abs(d.z));
    if (!(largest > 0.0LF) || isinf(largest) || isnan(d.x) || isnan(d.y) || isnan(d.z))
        return false;
    dvec3 e = dvec3(0.0LF);
    for (int a = 0; a < 3; a++)
        set(e, a, quotient(get(d, a), largest));
    precise double square = e.x * e.x + e.y * e.y;
    square = square + e.z * e.z;
    double size = root_of(square);
    for (int a = 0; a < 3; a++)
        set(d, a, quotient(get(e, a), size));
    return true;
}

// Stores the normal of a gradient in index space. Where it vanishes the vertex is listed: its
// normal comes from the triangles around it. slot, edge: where the vertex is.
void store_gradient(uint n, dvec3 g, uint slot, uint edge)
{
    dvec3 d = dvec3(0.0LF);
    if (normalise(g))
        for (int r = 0; r < 3; r++) {
            precise double sum = COFACTOR(r, 0) * g.x + COFACTOR(r, 1) * g.y;
            sum = sum + COFACTOR(r, 2) * g.z;
            set(d, r, sum);
        }
    if (normalise(d)) {
        store_normal(n, vec3(float(d.x), float(d.y), float(d.z)));
        return;
    }
    store_normal(n, vec3(0.0));
    uint at = atomicAdd(totals[MISSING], 1u);
    if (at < MEND_CAPACITY)
        missing[at] = uvec4(n, slot, edge, 0u);
}
