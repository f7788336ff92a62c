#version 330 core
// Composites the mean of frames at sub-pixel offsets, which composite.frag has added up, into the host's framebuffer. Permutations: SAMPLES n
// and REVERSED, of the frame without an offset, as in composite.frag.
//
// Its depth is that frame's, so that what is picked by depth is the same as without the others. A pixel that only the others cover has the
// nearest depth of its neighbours: what is in it lies about a pixel from one of these. If there is none it is one that closes a gap,
// and has the depth of the nearest covered pixel of those around it.

#ifdef SAMPLES
uniform sampler2DMS depths;
#else
uniform sampler2D depths;
#endif
uniform sampler2D sums;    // sums of colours times coverage, and of coverage
uniform float frames;
uniform ivec2 size;
uniform ivec2 corner;      // corner of the viewport, in the target's pixels
uniform vec2 depth_range;  // depth range of the target

layout(location = 0) out vec4 fragment;

#ifdef REVERSED
float nearer(float a, float b) { return max(a, b); }
const float farthest = 0.0;
#else
float nearer(float a, float b) { return min(a, b); }
const float farthest = 1.0;
#endif

float depth_at(ivec2 at)
{
#ifdef SAMPLES
    float depth = farthest;
    for (int i = 0; i < SAMPLES; ++i) depth = nearer(depth, texelFetch(depths, at, i).r);
    return depth;
#else
    return texelFetch(depths, at, 0).r;
#endif
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy) - corner;
    vec4 sum = texelFetch(sums, at, 0);
    if (!(sum.a > 0.0)) discard;
    fragment = vec4(sum.rgb / sum.a, sum.a / frames);
    float depth = depth_at(at);
    for (int reach = 1; depth == farthest && reach <= 5; ++reach)
        for (int y = max(at.y - reach, 0); y <= min(at.y + reach, size.y - 1); ++y)
            for (int x = max(at.x - reach, 0); x <= min(at.x + reach, size.x - 1); ++x) depth = nearer(depth, depth_at(ivec2(x, y)));
#ifdef REVERSED
    depth = 1.0 - depth;
#endif
    gl_FragDepth = mix(depth_range.x, depth_range.y, depth);
}
