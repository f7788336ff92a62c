#version 330 core
// A segment of a line with round ends, antialiased, and a dark border of one pixel.
in vec2 from_start;  // along and across the segment, pixels
flat in vec2 length_and_half;
flat in vec4 line_colour;

layout(location = 0) out vec4 fragment;

void main()
{
    float past = max(max(-from_start.x, from_start.x - length_and_half.x), 0.0);
    float away = length(vec2(past, from_start.y));
    float line = clamp(length_and_half.y + 0.5 - away, 0.0, 1.0);
    float dark = 0.5 * clamp(length_and_half.y + 1.5 - away, 0.0, 1.0);
    float opacity = line + (1.0 - line) * dark;
    if (!(opacity * line_colour.a > 0.0)) discard;
    fragment = vec4(line_colour.rgb * (line / opacity), opacity * line_colour.a);
}
