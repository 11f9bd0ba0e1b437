# made by bindings/generate.sh from bindings/status.toml
"""The words of a status, of an event and of what headings from outside are worth, as types."""

import typing

{% for one, is_small in [(by_name.Status, true), (by_name.EventKind, false), (by_name.HeadingAid, true)] %}
{{ one.name }} = typing.Literal[
{% for case in one.cases %}
    "{{ case.name|snake if is_small else case.name }}",  # {{ case.meaning }}
{% endfor %}
]
"""{{ one.meaning }}"""
{{ "\n" if not loop.last }}
{%- endfor %}
