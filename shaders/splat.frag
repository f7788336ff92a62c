#version 330 core
// Fills a splat. Permutations as in splat.vert, and SAMPLES: samples per pixel, where discs are antialiased.
#if defined(SAMPLES)
#extension GL_ARB_sample_shading : require
#endif

flat in vec4 splat_colour;
layout(location = 0) out vec4 fragment;

#if defined(AFFINE) || defined(DISC)

// As in splat.vert.
float mark_of(float side) { return (255.0 - clamp(floor(2.0 * log2(max(side, 1.0)) + 0.5), 0.0, 15.0)) / 255.0; }

// See splat.vert.
flat in vec4 base_and_rest;
flat in vec4 along;
flat in vec2 origin;
flat in vec3 divisor;
flat in vec3 depth_line;

// Also false where a value is NaN.
bool is_inside(vec2 p)
{
    vec2 place = (origin + p.x * along.xy + p.y * along.zw) / (divisor.x + dot(p, divisor.yz));
    return dot(place, place) <= 1.0;
}

#if defined(SAMPLES)
uniform vec2 sample_places[SAMPLES];  // relative to the pixel's centre
#endif

#if defined(AFFINE)
uniform vec2 depth_of;
#endif

void main()
{
    vec2 p = (gl_FragCoord.xy - base_and_rest.xy) - base_and_rest.zw;
#if defined(SAMPLES)
    int mask = 0;
    for (int i = 0; i < SAMPLES; ++i)
        if (is_inside(p + sample_places[i])) mask |= 1 << i;
    if (mask == 0) discard;
    gl_SampleMask[0] = mask;
#else
    if (!is_inside(p)) discard;
#endif
    float depth = depth_line.x + dot(p, depth_line.yz);
#if defined(AFFINE)
    if (!(depth > 0.0)) discard;
    depth = depth_of.x + depth_of.y / depth;
#endif
    // The near and the far plane. Hits behind the eye have depths beyond the near one.
    if (!(depth >= 0.0 && depth <= 1.0)) discard;
    gl_FragDepth = depth;
    // The ellipse on the screen is as wide as a circle of its area. (Near the eye, where the divisor varies, that is a guess.)
    float places = abs(along.x * along.w - along.y * along.z) / (divisor.x * divisor.x);  // area of a pixel, in radii squared
    fragment = vec4(splat_colour.rgb, mark_of(2.0 * inversesqrt(max(places, 1e-6))));
}

#elif defined(FITTED)

// See splat.vert.
flat in vec3 conic;
flat in vec2 centre;
flat in vec4 depth_line;
flat in float depth_most;
uniform vec2 depth_of;

void main()
{
    vec2 p = gl_FragCoord.xy - centre;
    float q = dot(conic, vec3(p.x * p.x, p.x * p.y, p.y * p.y));
    if (!(q <= 1.0)) discard;
    float depth = depth_line.x + clamp(dot(p, depth_line.yz), -depth_most, depth_most) + depth_line.w * q;
    // What lies before the near plane is cut off. Where a rim reaches beyond the far plane it is drawn at it: its point is in view.
#if defined(ORTHOGRAPHIC)
    bool near_is_1 = depth_of.y < 0.0;
#else
    bool near_is_1 = depth_of.y > 0.0;
#endif
    if (near_is_1 ? depth > 1.0 : depth < 0.0) discard;
    gl_FragDepth = clamp(depth, 6e-8, 0.99999994);
    fragment = splat_colour;
}

#elif defined(PARABOLOID)

flat in vec3 depth_radius_side;
flat in vec2 centre;
uniform vec2 depth_of;

// Schuetz and Wimmer 2015: the depth of a paraboloid that opens away from the eye. Splats of less than three pixels fill their squares, or
// they would lose pixels. The place in the square is found here: for gl_PointCoord drivers round the square's place (to 1/256 of a pixel) and
// its side (NVIDIA's: down to 1/32).
void main()
{
    vec2 place = (gl_FragCoord.xy - centre) * (2.0 / depth_radius_side.z);
    float q = dot(place, place);
    if (q > 1.0 && depth_radius_side.z > 3.0) discard;
    float depth = depth_radius_side.x + 0.5 * depth_radius_side.y * q;
#if defined(ORTHOGRAPHIC)
    depth = depth_of.x + depth_of.y * depth;
#else
    depth = depth_of.x + depth_of.y / depth;
#endif
    // Where a paraboloid reaches beyond the far plane it is drawn at it, just before what the buffer was cleared with: its point is in view.
    gl_FragDepth = clamp(depth, 6e-8, 0.99999994);
    fragment = splat_colour;
}

#else

void main() { fragment = splat_colour; }

#endif
