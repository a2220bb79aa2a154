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
    float light = mix(1.0, 0.34 + 0.46 * from_lamp + 0.24 * from_sky, u_lit);
    float glare = 0.0;
    if (u_gloss > 0.0)
        glare = u_gloss * pow(max(dot(normal, normalize(lamp - normalize(v_eye))), 0.0), 60.0);
    gl_FragColor = vec4(v_color.rgb * light + glare, v_color.a);
}
"""
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
