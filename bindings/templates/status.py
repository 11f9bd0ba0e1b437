# made by bindings/generate.sh from bindings/status.toml
"""The words of a status, of an event and of what headings from outside are worth, as types."""

import typing

{% for one, spelling in [(by_name.Status, "snake"), (by_name.EventKind, "name"), (by_name.HeadingAid, "snake")] %}
{{ one.name }} = typing.Literal[
{% for case in one.cases %}
    "{{ case[spelling] }}",  # {{ case.meaning }}
{% endfor %}
]
"""{{ one.meaning }}"""
{{ "\n" if not loop.last }}
{%- endfor %}
