// made by bindings/generate.sh from bindings/config.toml
package org.magcomp.core

// For Java, which has no named arguments. A field that is not set has the library's default; null unsets a field.
{% for group in settings if group.app in ["CompensationConfig", "HeadingConfig"] %}

/** Makes a [{{ group.app }}] from Java: `new {{ group.app }}Builder().{{ group.fields[0].camel }}(...).build()`. */
public class {{ group.app }}Builder {
    private var built = {{ group.app }}()

{% for field in group.fields %}
    /** Sets [{{ group.app }}.{{ field.camel }}]. */
    public fun {{ field.camel }}(value: {{ field.kotlin }}?): {{ group.app }}Builder = apply { built = built.copy({{ field.camel }} = value) }

{% endfor %}
    /** What was set so far. */
    public fun build(): {{ group.app }} = built
}
{% endfor %}
