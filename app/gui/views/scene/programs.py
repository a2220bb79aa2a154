"""The shaders of surfaces, compiled for one context; they need OpenGL 2.1 with instanced arrays."""

from __future__ import annotations

from OpenGL import GL
from OpenGL.GL import shaders

_VERTEX = """
#version 120
attribute vec3 a_position;
attribute vec3 a_normal;
attribute vec4 a_color;
attribute vec3 a_place;
attribute vec4 a_turn;
uniform mat4 u_eye;
uniform mat4 u_projection;
varying vec3 v_eye;
varying vec3 v_normal;
varying vec4 v_color;
vec3 turned(vec3 v) {
    // A quaternion of zeros takes everything to one point: such an instance has no face.
    return (a_turn.w * a_turn.w - dot(a_turn.xyz, a_turn.xyz)) * v
        + 2.0 * dot(a_turn.xyz, v) * a_turn.xyz + 2.0 * a_turn.w * cross(a_turn.xyz, v);
}
void main() {
    vec4 seen = u_eye * vec4(a_place + turned(a_position), 1.0);
    v_eye = seen.xyz;
    v_normal = mat3(u_eye) * turned(a_normal);
    v_color = a_color;
    gl_Position = u_projection * seen;
}
"""
_FRAGMENT = """
#version 120
uniform vec3 u_up;
uniform float u_gloss;
uniform float u_lit;
varying vec3 v_eye;
varying vec3 v_normal;
varying vec4 v_color;
void main() {
    // The face's own normal turns to the eye, however its corners are ordered. Where the smooth normal is far
    // from it there is a crease.
    vec3 face = normalize(cross(dFdx(v_eye), dFdy(v_eye)));
    vec3 smooth_normal = normalize(v_normal);
    float along = dot(face, smooth_normal);
    smooth_normal *= sign(along);
    vec3 normal = normalize(mix(face, smooth_normal, smoothstep(0.82, 0.94, abs(along))));
    const vec3 lamp = vec3(-0.33, 0.41, 0.85);
    float from_lamp = max(dot(normal, lamp), 0.0);
    float from_sky = 0.5 + 0.5 * dot(normal, u_up);
    float light = mix(1.0, 0.34 + 0.52 * from_lamp + 0.22 * from_sky, u_lit);
    float glare = 0.0;
    if (u_gloss > 0.0)
        glare = u_gloss * pow(max(dot(normal, normalize(lamp - normalize(v_eye))), 0.0), 60.0);
    gl_FragColor = vec4(v_color.rgb * light + glare, v_color.a);
}
"""
_GROUND_VERTEX = """
#version 120
attribute vec3 a_position;
uniform mat4 u_eye;
uniform mat4 u_projection;
uniform vec3 u_middle;
varying vec2 v_place;
void main() {
    v_place = a_position.xy - u_middle.xy;
    gl_Position = u_projection * u_eye * vec4(a_position, 1.0);
}
"""
_GROUND_FRAGMENT = """
#version 120
uniform vec3 u_plane;
uniform vec3 u_line;
uniform vec3 u_background;
uniform vec2 u_half;
uniform vec3 u_middle;
uniform float u_grid;
uniform float u_fades;
uniform sampler2D u_shadow;
varying vec2 v_place;
float lines(vec2 place, float width) {
    // A line a pixel wide at each whole number; none where they would lie closer than some pixels.
    vec2 pixel = fwidth(place);
    vec2 away = abs(fract(place - 0.5) - 0.5) / pixel;
    float crowded = max(pixel.x, pixel.y);
    return clamp(width - min(away.x, away.y), 0.0, 1.0) * (1.0 - smoothstep(0.08, 0.3, crowded));
}
void main() {
    vec2 share = v_place / u_half;
    float there = u_fades > 0.5 ? 1.0 - smoothstep(0.5, 1.0, length(share)) : 1.0;
    if (there <= 0.0) discard;
    float line = 0.0;
    if (u_grid > 0.0) {
        vec2 place = (v_place + u_middle.xy) / u_grid;
        line = max(0.45 * lines(place, 0.8), 0.9 * lines(place / 5.0, 1.0));
    }
    float light = 1.0 - texture2D(u_shadow, 0.5 + 0.5 * share).r;
    gl_FragColor = vec4(mix(u_background, mix(u_plane, u_line, line) * light, there), 1.0);
}
"""
_GROUND_UNIFORMS = (
    "eye",
    "projection",
    "plane",
    "line",
    "background",
    "half",
    "middle",
    "grid",
    "fades",
    "shadow",
)
POSITION, NORMAL, COLOR, PLACE, TURN = range(5)
_ATTRIBUTES = {
    POSITION: "a_position",
    NORMAL: "a_normal",
    COLOR: "a_color",
    PLACE: "a_place",
    TURN: "a_turn",
}


class SurfaceProgram:
    """Lit triangles, one body or many instances of it.

    Attributes:
        id: OpenGL's name of it.
    """

    def __init__(self) -> None:
        self.id = linked(_VERTEX, _FRAGMENT, _ATTRIBUTES)
        self.eye = GL.glGetUniformLocation(self.id, "u_eye")
        self.projection = GL.glGetUniformLocation(self.id, "u_projection")
        self.up = GL.glGetUniformLocation(self.id, "u_up")
        self.gloss = GL.glGetUniformLocation(self.id, "u_gloss")
        self.lit = GL.glGetUniformLocation(self.id, "u_lit")


class GroundProgram:
    """A plane with a grid and a map of shadows.

    Attributes:
        id: OpenGL's name of it.
        at: the locations of its uniforms.
    """

    def __init__(self) -> None:
        self.id = linked(_GROUND_VERTEX, _GROUND_FRAGMENT, {POSITION: "a_position"})
        self.at = {name: GL.glGetUniformLocation(self.id, f"u_{name}") for name in _GROUND_UNIFORMS}


def linked(vertex: str, fragment: str, attributes: dict[int, str]) -> int:
    """Return a program of two shaders, with its attributes at the locations given."""
    program = shaders.compileProgram(
        shaders.compileShader(vertex.lstrip(), GL.GL_VERTEX_SHADER),
        shaders.compileShader(fragment.lstrip(), GL.GL_FRAGMENT_SHADER),
        validate=False,
    )
    for location, name in attributes.items():
        GL.glBindAttribLocation(program, location, name)
    GL.glLinkProgram(program)
    return int(program)
