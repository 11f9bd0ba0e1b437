// made by bindings/generate.sh from bindings/config.toml
package org.magcomp.core

// For Java, which has no named arguments. A field that is not set has the library's default; null unsets a field.
{% for group in settings if group.name|app in ["CompensationConfig", "HeadingConfig"] %}

/** Makes a [{{ group.name|app }}] from Java: `new {{ group.name|app }}Builder().{{ group.fields[0].name|camel }}(...).build()`. */
public class {{ group.name|app }}Builder {
    private var built = {{ group.name|app }}()

{% for field in group.fields %}
    /** Sets [{{ group.name|app }}.{{ field.name|camel }}]. */
    public fun {{ field.name|camel }}(value: {{ {"real": "Double", "count": "Int", "flag": "Boolean"}[field.kind]|default(field.kind|app) }}?): {{ group.name|app }}Builder = apply { built = built.copy({{ field.name|camel }} = value) }

{% endfor %}
    /** What was set so far. */
    public fun build(): {{ group.name|app }} = built
}
{% endfor %}
