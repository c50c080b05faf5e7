// Builds the surface of cells that has vertices inside them, one cell a thread, as
// core/cases/cell_topology.c does: cones, and tunnels between two loops.
layout(local_size_x = 64) in;

double crossing[12], inner[4][3];
uint config_at, code, inner_count, first_inner, near[8];
int corners[54], corner_count; // of triangles: edges, or 12 and the number of a vertex inside
ivec3 cell;
double flat_at[2][12][2], turn[2]; // of a tunnel's loops
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
    return axis == edge >> 2 ? crossing[edge] : double(from[axis]);
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
            precise double apex[3] = double[3](0.0LF, 0.0LF, 0.0LF);
            for (int i = 0; i < count; i++) {
                for (int a = 0; a < 3; a++)
                    apex[a] =
                        apex[a] + edge_coordinate(loop_edge(first + i), a) / double(count);
                add_triangle(loop_edge(first + i), loop_edge(first + (i + 1) % count), top);
            }
            for (int a = 0; a < 3; a++)
                inner[inner_count][a] = apex[a];
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
double stretch[3];

double mirrored(double x, int axis)
{
    precise double y = (corner >> axis & 1) != 0 ? 1.0LF - x : x;
    return y;
}

void project_point(double p[3], out double flat_x, out double flat_y)
{
    precise double x[3];
    int v = (along_axis + 1) % 3, w = (along_axis + 2) % 3;
    for (int a = 0; a < 3; a++)
        x[a] = mirrored(p[a], a);
    if (central) {
        precise double sum = x[0] + x[1];
        sum = sum + x[2];
        precise double p0 = x[0] / sum, p1 = x[1] / sum;
        flat_x = p0;
        flat_y = p1;
    } else {
        precise double d = x[v] - x[w];
        flat_x = x[along_axis];
        flat_y = d;
    }
}

void lift_point(double flat_x, double flat_y, int n)
{
    int v = (along_axis + 1) % 3, w = (along_axis + 2) % 3;
    precise double p[3];
    if (central) {
        precise double x[3];
        x[0] = flat_x;
        x[1] = flat_y;
        x[2] = 1.0LF - flat_x;
        x[2] = x[2] - flat_y;
        precise double sum = x[0] / stretch[0] + x[1] / stretch[1];
        sum = sum + x[2] / stretch[2];
        for (int a = 0; a < 3; a++)
            p[a] = x[a] / sum;
    } else {
        precise double half_y = 0.5LF * flat_y;
        p[along_axis] = flat_x;
        p[v] = 0.5LF + half_y;
        p[w] = 0.5LF - half_y;
    }
    for (int a = 0; a < 3; a++)
        inner[n][a] = mirrored(p[a], a);
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
        double p[3];
        flat_edge[i][n] = loop_edge(first + n);
        for (int a = 0; a < 3; a++)
            p[a] = edge_coordinate(flat_edge[i][n], a);
        project_point(p, flat_at[i][n][0], flat_at[i][n][1]);
    }
    precise double area = 0.0LF;
    for (int n = 2; n < flat_count[i]; n++)
        area = area + cross_in_plane(flat_at[i][0][0], flat_at[i][0][1], flat_at[i][n - 1][0],
                                     flat_at[i][n - 1][1], flat_at[i][n][0], flat_at[i][n][1]);
    turn[i] = area < 0.0LF ? -1.0LF : 1.0LF;
}

double measure_clearance(int i, double cx, double cy)
{
    double least = 1.0LF;
    for (int n = 0; n < flat_count[i]; n++) {
        int m = (n + 1) % flat_count[i];
        double px = flat_at[i][n][0], py = flat_at[i][n][1], qx = flat_at[i][m][0],
               qy = flat_at[i][m][1];
        precise double dx = qx - px, dy = qy - py;
        precise double square = dx * dx + dy * dy;
        precise double size = sqrt(square);
        precise double clear = turn[i] * cross_in_plane(px, py, qx, qy, cx, cy);
        if (size > 0.0LF) {
            clear = clear / size;
            least = min(least, clear);
        }
    }
    return max(least, 1e-6LF);
}

const double ring_x[3] = double[3](1.0LF, -0.5LF, -0.5LF),
             ring_y[3] = double[3](0.0LF, 0.86602540378443865LF, -0.86602540378443865LF);

int find_farthest(int loop, double cx, double cy, int i, int j)
{
    precise double ex = ring_x[i] + ring_x[j], ey = ring_y[i] + ring_y[j];
    double most = 0.0LF;
    int found = 0;
    for (int n = 0; n < flat_count[loop]; n++) {
        precise double p = ex * (flat_at[loop][n][0] - cx), q = ey * (flat_at[loop][n][1] - cy);
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
    int step = turn[loop] > 0.0LF ? 1 : 2, count = flat_count[loop], walked = 0;
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
            double p[3] = double[3](double(c & 1), double(c >> 1 & 1), double(c >> 2 & 1)), x,
                   y;
            project_point(p, x, y);
            sum_x = sum_x + x;
            sum_y = sum_y + y;
            count++;
        }
    sum_x = sum_x / double(count);
    sum_y = sum_y / double(count);
    cx = sum_x;
    cy = sum_y;
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
            double t = crossing[edge_between(corner, corner ^ 1 << a)];
            precise double far = 0.5LF * mirrored(t, a);
            far = 0.5LF + far;
            stretch[a] = far;
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
        precise double x = radius * ring_x[i], y = radius * ring_y[i];
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
bool inner_gradient(ivec3 v, double p[3], out double g[3])
{
    bool is_there = true;
    precise double sum[3] = double[3](0.0LF, 0.0LF, 0.0LF);
    for (int c = 0; c < 8; c++) {
        precise double wx = (c & 1) != 0 ? p[0] : 1.0LF - p[0],
                       wy = (c & 2) != 0 ? p[1] : 1.0LF - p[1],
                       wz = (c & 4) != 0 ? p[2] : 1.0LF - p[2];
        precise double weight = wx * wy;
        weight = weight * wz;
        ivec3 at = v + ivec3(c & 1, c >> 1 & 1, c >> 2);
        for (int a = 0; a < 3; a++) {
            ivec3 along = ivec3(a == 0, a == 1, a == 2);
            precise double slope =
                half_at(at + along, is_there) - half_at(at - along, is_there);
            slope = weight * slope;
            sum[a] = sum[a] + slope;
        }
    }
    for (int a = 0; a < 3; a++)
        g[a] = sum[a];
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
        crossing[e] = edge_crossing(has_a, a, has_b, b);
    }
    build_discs();
    if (code >> 10 != 0u)
        build_tunnel();
    write_triangles(3u * open.z);
    for (uint i = 0u; i < inner_count; i++) {
        double p[3] = double[3](inner[i][0], inner[i][1], inner[i][2]), g[3];
        store_position(first_inner + i, at, p);
        if (!inner_gradient(v, p, g))
            g = double[3](0.0LF, 0.0LF, 0.0LF);
        store_gradient(first_inner + i, g, slot, 1536u | (open.x & 511u));
    }
}
