// Builds the surface of cells that has vertices inside them, one cell a thread, as
// core/cases/cell_topology.c does: cones, and tunnels between two loops.
layout(local_size_x = 64) in;

uvec2 crossing[12], inner[12];
uint config_at, code, inner_count, first_inner, near[8];
int corners[54], corner_count; // of triangles: edges, or 12 and the number of a vertex inside
ivec3 cell;
uvec2 flat_bits[48], turn[2]; // of a tunnel's loops
int flat_edge[2][12], flat_count[2];

uint vertex_of(int n)
{
    return n < 12 ? cell_vertex(near, cell, n) : first_inner + uint(n - 12);
}

void add_triangle(int i, int j, int k)
{
    corners[corner_count] = i;
    corners[corner_count + 1] = j;
    corners[corner_count + 2] = k;
    corner_count += 3;
}

// Writes the triangles that were added: in one place, as compilers copy what a loop calls.
void write_triangles(uint first)
{
    for (int n = 0; n < corner_count; n++) {
        int c = n % 3, from = FLIP && c != 0 ? n - c + 3 - c : n;
        indices[first + uint(n)] = vertex_of(corners[from]);
    }
}

int loop_count()
{
    return int(tables[config_at] & 7u);
}

int loop_length(int l)
{
    return int(tables[config_at] >> (3 + 4 * l) & 15u);
}

bool is_cone(int l)
{
    return (tables[config_at] >> (19 + l) & 1u) != 0u;
}

int loop_edge(int n)
{
    return int(tables[config_at + 2u + uint(n) / 8u] >> (4 * (n % 8)) & 15u);
}

int patch_of(int corner)
{
    return int(tables[config_at + 1u] >> (3 * corner) & 7u);
}

int tunnel_loop(int i)
{
    return int(code >> (13 + 6 * i) & 7u) - 1;
}

int tunnel_corner(int i)
{
    return int(code >> (10 + 6 * i) & 7u);
}

double edge_coordinate(int edge, int axis)
{
    ivec3 from = edge_begin(edge);
    return axis == edge >> 2 ? unpack(crossing[edge]) : double(from[axis]);
}

void build_discs()
{
    int first = 0;
    uint disc = 0u;
    for (int l = 0; l < loop_count(); first += loop_length(l++)) {
        bool tube = l == tunnel_loop(0) || l == tunnel_loop(1);
        int count = loop_length(l);
        if (is_cone(l) && !tube) {
            int top = 12 + int(inner_count);
            for (int i = 0; i < count; i++)
                add_triangle(loop_edge(first + i), loop_edge(first + (i + 1) % count), top);
            for (int a = 0; a < 3; a++) {
                precise double apex = 0.0LF;
                for (int i = 0; i < count; i++)
                    apex = apex +
                           quotient(edge_coordinate(loop_edge(first + i), a), double(count));
                inner[3u * inner_count + uint(a)] = pack(apex);
            }
            inner_count++;
        }
        for (int i = 0; i < count - 2 && !is_cone(l); i++, disc += 3u)
            if (!tube)
                add_triangle(int(config_edge(code & 1023u, disc)),
                             int(config_edge(code & 1023u, disc + 1u)),
                             int(config_edge(code & 1023u, disc + 2u)));
    }
}

// ---- tunnels ---------------------------------------------------------------------------------

bool central;
int corner, along_axis;
dvec3 stretch;

double mirrored(double x, int axis)
{
    precise double y = (corner >> axis & 1) != 0 ? 1.0LF - x : x;
    return y;
}

dvec3 mirror_point(dvec3 p)
{
    return dvec3(mirrored(p.x, 0), mirrored(p.y, 1), mirrored(p.z, 2));
}

void project_point(dvec3 p, out double flat_x, out double flat_y)
{
    precise dvec3 x = mirror_point(p);
    if (central) {
        precise double sum = x.x + x.y;
        sum = sum + x.z;
        flat_x = quotient(x.x, sum);
        flat_y = quotient(x.y, sum);
    } else {
        precise double d = get(x, (along_axis + 1) % 3) - get(x, (along_axis + 2) % 3);
        flat_x = get(x, along_axis);
        flat_y = d;
    }
}

void lift_point(double flat_x, double flat_y, int n)
{
    dvec3 p = dvec3(0.0LF);
    if (central) {
        precise double third = 1.0LF - flat_x;
        third = third - flat_y;
        dvec3 x = dvec3(flat_x, flat_y, third);
        precise double sum = 0.0LF;
        for (int a = 0; a < 3; a++)
            sum = sum + quotient(get(x, a), get(stretch, a));
        for (int a = 0; a < 3; a++)
            set(p, a, quotient(get(x, a), sum));
    } else {
        precise double half_y = 0.5LF * flat_y;
        precise double above = 0.5LF + half_y, below = 0.5LF - half_y;
        set(p, along_axis, flat_x);
        set(p, (along_axis + 1) % 3, above);
        set(p, (along_axis + 2) % 3, below);
    }
    for (int a = 0; a < 3; a++)
        inner[3 * n + a] = pack(mirrored(get(p, a), a));
}

double flat_at(int loop, int n, int axis)
{
    return unpack(flat_bits[24 * loop + 2 * n + axis]);
}

double cross_in_plane(double ox, double oy, double ax, double ay, double bx, double by)
{
    precise double p = (ax - ox) * (by - oy), q = (ay - oy) * (bx - ox);
    precise double d = p - q;
    return d;
}

void flatten_loop(int i)
{
    int first = 0, loop = tunnel_loop(i);
    for (int l = 0; l < loop; l++)
        first += loop_length(l);
    flat_count[i] = loop_length(loop);
    for (int n = 0; n < flat_count[i]; n++) {
        dvec3 p = dvec3(0.0LF);
        double x, y;
        flat_edge[i][n] = loop_edge(first + n);
        for (int a = 0; a < 3; a++)
            set(p, a, edge_coordinate(flat_edge[i][n], a));
        project_point(p, x, y);
        flat_bits[24 * i + 2 * n] = pack(x);
        flat_bits[24 * i + 2 * n + 1] = pack(y);
    }
    precise double area = 0.0LF;
    for (int n = 2; n < flat_count[i]; n++)
        area = area + cross_in_plane(flat_at(i, 0, 0), flat_at(i, 0, 1), flat_at(i, n - 1, 0),
                                     flat_at(i, n - 1, 1), flat_at(i, n, 0), flat_at(i, n, 1));
    turn[i] = pack(area < 0.0LF ? -1.0LF : 1.0LF);
}

double measure_clearance(int i, double cx, double cy)
{
    double least = 1.0LF;
    for (int n = 0; n < flat_count[i]; n++) {
        int m = (n + 1) % flat_count[i];
        double px = flat_at(i, n, 0), py = flat_at(i, n, 1), qx = flat_at(i, m, 0),
               qy = flat_at(i, m, 1);
        precise double dx = qx - px, dy = qy - py;
        precise double square = dx * dx + dy * dy;
        double size = root_of(square);
        precise double clear = unpack(turn[i]) * cross_in_plane(px, py, qx, qy, cx, cy);
        if (size > 0.0LF) {
            clear = quotient(clear, size);
            least = min(least, clear);
        }
    }
    return max(least, 1e-6LF);
}

double ring_x(int i)
{
    return i == 0 ? 1.0LF : -0.5LF;
}

// Half the root of 3, as the bits of its double.
double ring_y(int i)
{
    double y = unpack(uvec2(0xe8584caau, 0x3febb67au));
    return i == 0 ? 0.0LF : i == 1 ? y : -y;
}

int find_farthest(int loop, double cx, double cy, int i, int j)
{
    precise double ex = ring_x(i) + ring_x(j), ey = ring_y(i) + ring_y(j);
    double most = 0.0LF;
    int found = 0;
    for (int n = 0; n < flat_count[loop]; n++) {
        precise double p = ex * (flat_at(loop, n, 0) - cx), q = ey * (flat_at(loop, n, 1) - cy);
        precise double far = p + q;
        if (n == 0 || far > most) {
            most = far;
            found = n;
        }
    }
    return found;
}

void build_sheet(int loop, double cx, double cy, int ring)
{
    int step = unpack(turn[loop]) > 0.0LF ? 1 : 2, count = flat_count[loop], walked = 0;
    int i = find_farthest(loop, cx, cy, 2 * step % 3, 0);
    for (int n = 0; n < 3; n++) {
        int here = n * step % 3, following = (n + 1) * step % 3;
        int last = find_farthest(loop, cx, cy, here, following);
        int steps = n < 2 ? (last - i + count) % count : count - walked;
        for (int k = 0; k < steps; k++) {
            add_triangle(flat_edge[loop][i], flat_edge[loop][(i + 1) % count], ring + here);
            i = (i + 1) % count;
        }
        walked += steps;
        add_triangle(flat_edge[loop][i], ring + following, ring + here);
    }
}

void find_center(int of, out double cx, out double cy)
{
    precise double sum_x = 0.0LF, sum_y = 0.0LF;
    int count = 0;
    for (int c = 0; c < 8; c++)
        if (patch_of(c) == patch_of(of)) {
            double x, y;
            project_point(dvec3(c & 1, c >> 1 & 1, c >> 2 & 1), x, y);
            sum_x = sum_x + x;
            sum_y = sum_y + y;
            count++;
        }
    cx = quotient(sum_x, double(count));
    cy = quotient(sum_y, double(count));
}

int edge_between(int a, int b)
{
    int low = a & b, differs = a ^ b;
    return differs == 1   ? low >> 1
           : differs == 2 ? 4 + ((low & 1) | (low >> 1 & 2))
                          : 8 + (low & 3);
}

void build_tunnel()
{
    int end = loop_length(tunnel_loop(0)) == 3 ? 0 : loop_length(tunnel_loop(1)) == 3 ? 1 : -1;
    double cx = 0.5LF, cy = 0.0LF;
    along_axis = 0;
    if (end >= 0) {
        central = true;
        corner = tunnel_corner(end);
        for (int a = 0; a < 3; a++) {
            double t = unpack(crossing[edge_between(corner, corner ^ 1 << a)]);
            precise double far = 0.5LF * mirrored(t, a);
            far = 0.5LF + far;
            set(stretch, a, far);
        }
        find_center(tunnel_corner(1 - end), cx, cy);
    } else {
        central = false;
        corner = tunnel_corner(0);
        while (along_axis < 2 && patch_of(corner ^ 1 << along_axis) != patch_of(corner))
            along_axis++;
    }
    double clear = 1.0LF;
    for (int i = 0; i < 2; i++) {
        flatten_loop(i);
        clear = min(clear, measure_clearance(i, cx, cy));
    }
    precise double radius = 0.5LF * clear;
    for (int i = 0; i < 3; i++) {
        precise double x = radius * ring_x(i), y = radius * ring_y(i);
        x = cx + x;
        y = cy + y;
        lift_point(x, y, int(inner_count) + i);
    }
    for (int i = 0; i < 2; i++)
        build_sheet(i, cx, cy, 12 + int(inner_count));
    inner_count += 3u;
}

// ---- vertices --------------------------------------------------------------------------------

double half_at(ivec3 v, inout bool is_there)
{
    uint bits;
    is_there = fetch(v, bits) && is_finite(bits) && is_there;
    precise double half_value = 0.5LF * number_of(bits);
    return half_value;
}

// Interpolates the gradients of the corners; false where a neighbour is missing or infinite.
bool inner_gradient(ivec3 v, dvec3 p, out dvec3 g)
{
    bool is_there = true;
    precise dvec3 sum = dvec3(0.0LF), rest = dvec3(1.0LF) - p;
    for (int c = 0; c < 8; c++) {
        precise double weight = ((c & 1) != 0 ? p.x : rest.x) * ((c & 2) != 0 ? p.y : rest.y);
        weight = weight * ((c & 4) != 0 ? p.z : rest.z);
        ivec3 at = v + ivec3(c & 1, c >> 1 & 1, c >> 2);
        for (int a = 0; a < 3; a++) {
            ivec3 along = ivec3(a == 0, a == 1, a == 2);
            precise double slope =
                half_at(at + along, is_there) - half_at(at - along, is_there);
            slope = weight * slope;
            slope = get(sum, a) + slope;
            set(sum, a, slope);
        }
    }
    g = sum;
    return is_there;
}

void main()
{
    uint n = group_number() * 64u + gl_LocalInvocationIndex;
    if (n >= min(totals[OPEN], OPEN_CAPACITY))
        return;
    uvec4 open = open_cells[n];
    code = open.y;
    config_at = 256u + 8u * (code & 1023u);
    if (code >> 10 == 0u && tables[config_at] >> 28 == 0u)
        return;
    uint slot = open.x >> 9;
    cell = ivec3(open.x & 7u, open.x >> 3 & 7u, open.x >> 6 & 7u);
    find_slots(slot, near);
    corner_count = 0;
    first_inner = open.w;
    inner_count = 0u;
    ivec3 at = first_sample(active_blocks[slot]) + cell, v = at - 1;
    for (int e = 0; e < 12; e++) {
        ivec3 from = v + edge_begin(e), to = from + ivec3(e < 4, e >= 4 && e < 8, e >= 8);
        uint a, b;
        bool has_a = fetch(from, a), has_b = fetch(to, b);
        crossing[e] = pack(edge_crossing(has_a, a, has_b, b));
    }
    build_discs();
    if (code >> 10 != 0u)
        build_tunnel();
    write_triangles(3u * open.z);
    for (uint i = 0u; i < inner_count; i++) {
        dvec3 p = dvec3(unpack(inner[3u * i]), unpack(inner[3u * i + 1u]),
                        unpack(inner[3u * i + 2u])),
              g;
        store_position(first_inner + i, at, p);
        if (!inner_gradient(v, p, g))
            g = dvec3(0.0LF);
        store_gradient(first_inner + i, g, slot, 1536u | (open.x & 511u));
    }
}
