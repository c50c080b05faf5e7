// Draws a voxel's footprint [Westover1990], and adds its absorption to a sheet: optical depth,
// and colour times that. A Gaussian blob's footprint is an ellipse, by the linearised map of
// its place to the picture [Zwicker2001]; with POLYGON it is triangles between a middle and two
// rings [Laur1991]. IN_PLANE: the footprint is a B-spline across the lattice, linear (TENT) or
// cubic, whose sheet knows the way through it. NODES: it is the part of a node in a sheet, a
// rectangle of the lattice, blurred as its voxels would be, so that neighbours leave no seam.
#if defined(NODES) || defined(IN_PLANE)
#define RECTANGLES
#endif
#ifdef POLYGON
const int corners = 17;
#else
const int corners = 4;
#endif
#ifdef TENT
const float support = 1.0; // half of it, in steps
#else
const float support = 2.0;
#endif

#if defined(NODES) && !defined(IN_PLANE)
// Returns the step through index space, per unit, of a ray through a point of eye space.
vec3 slope_through(vec3 at)
{
    return mat3(index_from_eye) * (view.x > 0.5 ? normalize(at) : vec3(0.0, 0.0, -1.0));
}
#endif

uniform int axis;    // that sheets are across
uniform float steps; // of the B-spline, in voxels
#ifdef VERTEX
uniform samplerBuffer splats; // three texels each, see viewer/modes/splat_sheets.h
uniform float sigma, radius;  // of the blob of one voxel, in voxels; of the table, in sigmas
uniform float cell;           // volume of a voxel in eye space
out vec2 offset;              // from the middle, in sigmas; of rectangles in voxels
out float level;              // of the footprint, at a corner of the polygon
flat out vec4 node;           // half a node's sizes, reach of its blur
flat out float far_away;
out vec3 on_ray; // the point in eye space
out vec4 color;  // times the extinction; extinction; both times the height or density

// The blob's covariance on the picture: of J A A^T J^T.
mat2 covariance(vec3 at)
{
    mat3 a = mat3(eye_from_index);
    float d = -at.z;
    mat3x2 j = view.x > 0.5 ? mat3x2(1.0 / d, 0.0, 0.0, 1.0 / d, at.x / (d * d), at.y / (d * d))
                            : mat3x2(1.0, 0.0, 0.0, 1.0, 0.0, 0.0);
    mat3x2 m = sigma * (j * a);
    return m * transpose(m);
}

// Widened to at least half a pixel, so that the samples of the picture do not miss it.
mat2 widen(mat2 c)
{
    float pixel = 2.0 * picture.w / picture.y;
    float middle = 0.5 * (c[0][0] + c[1][1]);
    float least = middle - sqrt(max(middle * middle - determinant(c), 0.0));
    return c + mat2(max(0.25 * pixel * pixel - least, 0.0));
}

vec4 shine(vec4 row, vec3 gradient, vec3 at)
{
    vec3 slope = mat3(gradient_to_eye) * gradient;
#ifdef FACTOR
    row.a *= gradient_factor(slope);
#endif
#ifdef LIT
    row.rgb = shade_at(row.rgb, slope, view.x > 0.5 ? normalize(-at) : vec3(0.0, 0.0, 1.0), at);
#endif
    return row;
}

vec2 corner()
{
    return 2.0 * vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1) - 1.0;
}

// Places a corner of the polygon. Heights and rings are those whose sum on a lattice, turned in
// any way, varies least at a width of 0.6; it varies less when the polygon is turned a little.
void place_corner()
{
    int c = gl_VertexID % corners, ring = (c + 7) / 8;
    float angle = 0.25 * 3.14159265 * (float(c) + 0.25);
    offset = (ring == 0 ? 0.0 : ring == 1 ? 1.8 : 3.3) * vec2(cos(angle), sin(angle));
    level = ring == 0 ? 0.17148 : ring == 1 ? 0.030009 : 0.0;
}

void place_voxel(vec3 at, vec4 row, float mass)
{
    mat2 c = widen(covariance(at));
    float first = sqrt(c[0][0]), mixed = c[0][1] / first; // the root of c, after Cholesky
    float second = sqrt(max(c[1][1] - mixed * mixed, 1e-30));
#ifdef POLYGON
    place_corner();
#else
    offset = radius * corner();
#endif
    vec2 way = vec2(first * offset.x, mixed * offset.x + second * offset.y);
    vec3 beam = view.x > 0.5 ? at / -at.z : vec3(0.0, 0.0, -1.0);
    vec2 middle = view.x > 0.5 ? beam.xy : at.xy;
    float spread = view.x > 0.5 ? length(beam) / (at.z * at.z) : 1.0;
    float depth = mass * cell * spread * row.a / (first * second);
    vec4 plane = projection * vec4(0.0, 0.0, at.z, 1.0);
    color = vec4(row.rgb * depth, depth);
    on_ray = at;
    gl_Position = vec4((middle + way) / picture.zw, plane.z / plane.w, 1.0);
}

#ifdef RECTANGLES
// Returns the reach of a footprint across the lattice, beyond half the node's sizes.
vec2 blur_of(vec3 at)
{
#if defined(IN_PLANE) && defined(NODES)
    return vec2(steps * (support - 0.5));
#elif defined(IN_PLANE)
    return vec2(steps * support);
#else // a voxel's blob along a ray, measured in the sheet, is wider for oblique rays
    int b = (axis + 1) % 3, c = (axis + 2) % 3;
    vec3 slope = slope_through(at);
    vec2 lean = vec2(slope[b], slope[c]) / slope[axis];
    return sigma * sqrt(5.0 * (1.0 + lean * lean));
#endif
}

void place_rectangle(vec3 index, vec3 at, vec4 row, float mass, vec3 size)
{
    int b = (axis + 1) % 3, c = (axis + 2) % 3;
    node = vec4(0.5 * size[b], 0.5 * size[c], blur_of(at));
    offset = (node.xy + node.zw) * corner();
    index[b] += offset.x;
    index[c] += offset.y;
    vec3 place = (eye_from_index * vec4(index, 1.0)).xyz;
    color = vec4(row.rgb, 1.0) * (mass * row.a);
    on_ray = place;
    gl_Position = projection * vec4(place, 1.0);
}
#endif

void main()
{
    int n = 3 * (gl_VertexID / corners);
    vec4 place = texelFetch(splats, n), slope = texelFetch(splats, n + 1);
    vec3 at = (eye_from_index * vec4(place.xyz, 1.0)).xyz;
    vec4 row = shine(classify(place.w), slope.xyz, at);
    far_away = -at.z;
    level = 0.0;
    node = vec4(0.0);
#ifdef RECTANGLES
    place_rectangle(place.xyz, at, row, slope.w, texelFetch(splats, n + 2).xyz);
#else
    place_voxel(at, row, slope.w);
#endif
}
#else
uniform sampler2D footprint; // by the square of the distance, 0 to 1 at its end
uniform float radius;
in vec2 offset;
in float level;
flat in vec4 node;
flat in float far_away;
in vec3 on_ray;
in vec4 color;
out vec4 result;

#if defined(IN_PLANE) && !defined(NODES)
// Returns the B-spline.
vec2 spline(vec2 x)
{
    vec2 a = abs(x);
#ifdef TENT
    return max(1.0 - a, 0.0);
#else
    vec2 outer = max(2.0 - a, 0.0), inner = max(1.0 - a, 0.0);
    return outer * outer * outer / 6.0 - inner * inner * inner * (2.0 / 3.0);
#endif
}
#elif defined(IN_PLANE)
// Returns the sum of the B-splines of all voxels beyond an edge, at a distance within it.
vec2 rise(vec2 x)
{
#ifdef TENT
    return clamp(x + 0.5, 0.0, 1.0);
#else
    vec2 a = min(abs(x), 1.5), rest = 1.5 - a;
    vec2 half_rise = mix(0.5 - rest * rest * rest / 6.0, a * (0.75 - a * a / 3.0),
                         vec2(lessThan(a, vec2(0.5))));
    return 0.5 + sign(x) * half_rise;
#endif
}
#elif defined(NODES)
// The blur along one axis: a parabola as wide as the Gaussian, whose integral is cheap.
vec2 rise(vec2 x)
{
    return smoothstep(-node.zw, node.zw, x);
}
#endif

// Returns the height of the footprint; of a blob's node, multiplied by the way through the
// sheet.
float height()
{
#if defined(IN_PLANE) && !defined(NODES)
    vec2 factors = spline(offset / steps) / steps;
    return factors.x * factors.y;
#elif defined(IN_PLANE)
    vec2 factors = rise((offset + node.xy) / steps) - rise((offset - node.xy) / steps);
    return factors.x * factors.y;
#elif defined(NODES)
    vec2 factors = rise(offset + node.xy) - rise(offset - node.xy);
    return factors.x * factors.y / abs(slope_through(on_ray)[axis]);
#elif defined(POLYGON)
    return level;
#else
    float at = dot(offset, offset) / (radius * radius);
    return at < 1.0 ? texture(footprint, vec2((at * 255.0 + 0.5) / 256.0, 0.5)).r : 0.0;
#endif
}

void main()
{
    float share = height();
#ifndef IN_PLANE
    if (!(share > 0.0))
        discard;
#endif
    result = color * share;
    if (view.w > 0.0)
        result = attenuate(result, far_away, gl_FragCoord.y / picture.y);
}
#endif
