# made by bindings/generate.sh from bindings/config.toml
"""The settings and what they choose from, as types."""

from __future__ import annotations

import typing

{% for one in choices %}
{{ one.name }} = typing.Literal[
{% for case in one.cases %}
    "{{ case.name }}",  # {{ case.meaning }}
{% endfor %}
]
"""{{ one.meaning }}"""

{% endfor %}

class InitialCalibration(typing.TypedDict):
    """A calibration to begin with: M row by row, 9 numbers; b, 3 numbers, uT; |h|, uT."""

    soft_iron: typing.Sequence[float]
    hard_iron_ut: typing.Sequence[float]
    field_strength_ut: float
{% for group in settings|reverse if group.core %}


class {{ group.name|replace("Config", "Settings") }}(typing.TypedDict, total=False):
    """{{ group.meaning }}{{ " `Compensator().config` tells the defaults." if group.name == "Config" }}"""
{% for field in group.fields if field.core %}

    {{ field.name }}: {{ {"real": "float", "count": "int", "flag": "bool", "Calibration": "InitialCalibration"}[field.kind]|default(field.kind|replace("Config", "Settings")) }}{{ " | None" if field.none }}
    """{{ field.meaning|replace("{default}", field.usual) }}"""
{% endfor %}
{% endfor %}
