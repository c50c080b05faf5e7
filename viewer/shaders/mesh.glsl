// Triangles, lit on both sides or on their own, and the faces of what planes cut them to. Of these are made:
//   both stages, plain    the surface; with EDGES its triangles' edges too
//   COUNT                 how often the surface is left, less entered, beyond each of four planes
//   CAP, after screen     the part of a plane that is inside of the surface
#if defined(VERTEX) && !defined(CAP)
uniform mat4 eye_from_mesh;
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color;
layout(location = 3) in float scalar;
out vec3 at, direction;
out vec4 own; // colour, linear, and opacity
out float tint;
out vec3 share; // of the triangle's corners
#endif

vec3 linear_of(vec3 srgb)
{
    return mix(pow((srgb + 0.055) / 1.055, vec3(2.4)), srgb / 12.92,
               lessThanEqual(srgb, vec3(0.04045)));
}

#if defined(VERTEX) && !defined(CAP)
void main()
{
    vec4 eye = eye_from_mesh * vec4(position, 1.0);
    at = eye.xyz;
    direction = mat3(eye_from_mesh) * normal;
    own = vec4(linear_of(color.rgb), color.a);
    tint = scalar;
    share = vec3(equal(ivec3(gl_VertexID % 3), ivec3(0, 1, 2)));
    gl_Position = projection * eye;
}
#endif

#ifdef FRAGMENT
uniform sampler2D peeled, covered; // depth of the layer before; all layers before, blended
out vec4 result;

vec3 srgb_of(vec3 light)
{
    return mix(1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, 12.92 * light,
               lessThanEqual(light, vec3(0.0031308)));
}

// Lights a surface as viewer/cpu/reference_mesh.c does: from the eye, from above its left
// shoulder, and from everywhere.
vec3 studio(vec3 surface, vec3 n, vec3 v)
{
    vec3 fill = normalize(vec3(-0.55, 0.65, 0.52));
    float gloss = pow(max(dot(n, normalize(v + fill)), 0.0), 32.0);
    float light =
        0.09 + 0.05 * n.y + 0.56 * max(dot(n, v), 0.0) + 0.44 * max(dot(n, fill), 0.0);
    return srgb_of(clamp(surface * light + 0.08 * gloss, 0.0, 1.0));
}

// A point of a surface of some colour (linear) and opacity, by a unit normal, outward if one side
// is lit; premultiplied.
vec4 light_up(vec3 p, vec3 n, vec4 surface)
{
    vec3 v = view.x > 0.5 ? normalize(-p) : vec3(0.0, 0.0, 1.0);
#ifdef STUDIO
    vec3 shown = studio(surface.rgb, n, v);
#else
    vec3 shown = min(shade(srgb_of(surface.rgb), -n, v), 1.0);
#endif
    return attenuate(vec4(shown * surface.a, surface.a), -p.z, gl_FragCoord.y / picture.y);
}

// Returns true for a point in a layer before, or behind so much that it is not seen.
bool is_peeled(float z)
{
#ifdef PEEL
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    return z <= texelFetch(peeled, pixel, 0).r || texelFetch(covered, pixel, 0).a >= limits.x;
#else
    return false;
#endif
}
#endif

#if defined(FRAGMENT) && defined(COUNT)
in vec3 at;
uniform float first_plane;

// Counts windings. Along the ray a plane's function changes in one direction: beyond the plane
// it has the sign of its slope.
void main()
{
    vec3 along = view.x > 0.5 ? at : vec3(0.0, 0.0, -1.0);
    for (int i = 0; i < 4; i++) {
        vec4 plane = clips[int(first_plane) + i];
        float beyond = (dot(plane.xyz, at) - plane.w) * dot(plane.xyz, along);
        result[i] = beyond <= 0.0 ? 0.0 : gl_FrontFacing ? -1.0 : 1.0;
    }
}
#endif

#if defined(FRAGMENT) && defined(CAP)
uniform sampler2D winding;
uniform vec4 plain; // colour, linear, and opacity
uniform float plane;

void main()
{
    int n = int(plane);
    if (abs(texelFetch(winding, ivec2(gl_FragCoord.xy), 0)[n % 4]) < 0.5)
        discard;
    vec2 edge = (2.0 * gl_FragCoord.xy / picture.xy - 1.0) * picture.zw;
    vec3 origin = view.x > 0.5 ? vec3(0.0) : vec3(edge, 0.0);
    vec3 along = view.x > 0.5 ? vec3(edge, -1.0) : vec3(0.0, 0.0, -1.0);
    float slope = dot(clips[n].xyz, along);
    vec3 p = origin + (clips[n].w - dot(clips[n].xyz, origin)) / slope * along;
    if (slope == 0.0 || !(-p.z >= view.y && -p.z <= view.z))
        discard;
    for (int i = 0; i < counts.y; i++)
        if (i != n && dot(clips[i].xyz, p) < clips[i].w)
            discard;
    vec4 there = projection * vec4(p, 1.0);
    gl_FragDepth =
        0.5 * there.z / there.w + 0.5 - 2e-6; // in front of the surface that it ends at
    if (is_peeled(gl_FragDepth))
        discard;
    result = light_up(p, normalize(clips[n].xyz) * -sign(slope), plain);
}
#endif

#if defined(FRAGMENT) && !defined(COUNT) && !defined(CAP)
in vec3 at, direction;
in vec4 own;
in float tint;
in vec3 share;
uniform vec4 plain;
uniform sampler2D ramp;  // colours of what tints
uniform vec3 tint_range; // low, 1 / (high - low), rows of the ramp
uniform float line_width;
const vec3 inside = vec3(0.75, 0.22, 0.17), line_color = vec3(0.08, 0.10, 0.14),
           no_value = vec3(0.22);

vec4 surface_here()
{
    vec4 surface = plain;
#ifdef COLORED
    surface = own;
#endif
#ifdef TINTED
    float row =
        clamp((tint - tint_range.x) * tint_range.y, 0.0, 1.0) * (tint_range.z - 1.0) + 0.5;
    vec3 shown = texture(ramp, vec2(row / tint_range.z, 0.5)).rgb;
    surface.rgb = isnan(tint) ? no_value : linear_of(shown);
#endif
#ifdef SOLID
    surface.a = 1.0;
#endif
#ifdef SAME_INSIDE
    return surface;
#endif
    return gl_FrontFacing ? surface : vec4(surface.rgb * inside, surface.a);
}

// Returns the normal on the visible side, as the triangle's own.
vec3 normal_here(vec3 own_normal)
{
    float side = dot(direction, own_normal);
    return side == 0.0 ? own_normal : normalize(side < 0.0 ? -direction : direction);
}

// Returns how much of the sample an edge covers; of both triangles at it, each draws its half.
// Where triangles are only a few pixels high, edges fade, or they would hide the surface.
float edge_here(vec3 dx, vec3 dy)
{
    vec3 heights = 1.0 / max(sqrt(dx * dx + dy * dy), 1e-20), far = share * heights;
    float fade = min(min(heights.x, min(heights.y, heights.z)) / (10.0 * line_width), 1.0);
    return fade * clamp(line_width + 0.5 - min(far.x, min(far.y, far.z)), 0.0, 1.0);
}

void main()
{
    vec3 own_normal = normalize(cross(dFdx(at), dFdy(at)));
    float edge = edge_here(dFdx(share), dFdy(share));
    bool kept = true;
    for (int n = 0; n < counts.y; n++)
        kept = kept && dot(clips[n].xyz, at) >= clips[n].w;
    if ((counts.y > 0 && kept == (counts.z != 0)) || is_peeled(gl_FragCoord.z))
        discard;
    vec3 n = normal_here(own_normal);
    result = light_up(at, counts.w != 0 && !gl_FrontFacing ? -n : n, surface_here());
#ifdef EDGES
    result =
        mix(result, attenuate(vec4(line_color, 1.0), -at.z, gl_FragCoord.y / picture.y), edge);
#endif
}
#endif
