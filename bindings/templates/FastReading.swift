// swift-format-ignore-file
// made by bindings/generate.sh from bindings/status.toml and bindings/reading.toml
import MagcompFFI

// Converts the answers of the C path to the records that uniffi makes; a test compares every one with what uniffi says.

extension MagneticReading {
    init(_ c: MagcompReading, timeNs: Int64) {
{% for field in reading.fields if field.parts %}
        let {{ field.name|camel }} = known(c.{{ field.leaves[0].flat }}).map {
            {{ field.kind|swift }}({% for leaf in field.leaves %}{{ leaf.name|camel }}: {% if loop.first %}$0{% elif leaf.none %}known(c.{{ leaf.flat }}){% else %}c.{{ leaf.flat }}{% endif %}{{ ", " if not loop.last }}{% endfor %})
        }
{% endfor %}
        self.init(
            timeNs: timeNs,
{% for field in reading.fields %}
            {{ field.name|camel }}: {% if field.kind == "vector" %}vector(c.{{ field.name }}){% elif field.kind == "real" %}known(c.{{ field.name }}){% elif field.is_enum %}{{ field.kind|swift }}(c.{{ field.name }}){% elif field.parts %}{{ field.name|camel }}{% elif field.kind == "count" %}Int(c.{{ field.name }}){% else %}c.{{ field.name }}{% endif %},
{% endfor %}
            event: FieldEvent(c.event),
            status: CompensationStatus(c.status)
        )
    }
}

private func known(_ value: Double) -> Double? { value.isNaN ? nil : value }

private func vector(_ v: (Double, Double, Double)) -> DeviceVector? {
    v.0.isNaN ? nil : DeviceVector(x: v.0, y: v.1, z: v.2)
}

/// An axis as a number: 1 to 3, negative where it points the other way; 0 for what is none.
private func axis(_ number: Double) -> Int { Int(exactly: number) ?? 0 }

/// The header and the library are of one build: only a defect leads here.
private func unknown(_ what: String, _ code: Int32) -> Never {
    fatalError("\(what) \(code): the library's native part is of another version")
}

{% macro read(field) %}
{% if field.kind == "count" %}Int(clamping: c.whole.{{ field.place }}){% elif field.kind == "time" %}c.whole.{{ field.place }}{% elif field.kind == "axis" %}{{ "Axis"|swift }}(c.whole.{{ field.place }}){% elif field.kind == "signed_axis" %}axis(c.real.{{ field.place }}){% elif field.kind == "real" %}c.real.{{ field.place }}{% else %}{{ field.kind|swift }}(c){% endif %}
{%- endmacro %}
{% macro made(case) %}
.{{ case.name|camel }}{% if case.fields %}({% for field in case.fields %}{{ field.name|camel }}: {{ read(field) }}{{ ", " if not loop.last }}{% endfor %}){% endif %}
{%- endmacro %}
extension {{ "SensorMode"|swift }} {
    fileprivate init(_ code: Int32) {
        self =
            switch code {
{% for case in by_name.SensorMode.cases %}
            case {{ case.code }}: .{{ case.name|camel }}
{% endfor %}
            default: unknown("mode", code)
            }
    }
}

extension ModelOrder {
    fileprivate init?(_ code: Int32) {
        switch code {
{% for case in by_name.ModelOrder.cases %}
        case {{ case.code }}: self = .{{ case.name|camel }}
{% endfor %}
        default: return nil
        }
    }
}

extension FieldEvent {
    fileprivate init?(_ c: MagcompEvent) {
        let kind: {{ "EventKind"|swift }}? =
            switch c.kind {
{% for case in by_name.EventKind.cases %}
            case {{ case.code }}: .{{ case.name|camel }}
{% endfor %}
            default: nil
            }
        guard let kind else { return nil }
        self.init(kind: kind, sinceNs: c.since_ns, decidedNs: c.decided_ns)
    }
}

{% for one, code in [(by_name.Status, "kind"), (by_name.Missing, "reason"), (by_name.HoldReason, "reason"), (by_name.RejectReason, "reason"), (by_name.FitProblem, "problem")] %}
extension {{ one.name|swift }} {
    {{ "fileprivate " if one.name != "Status" }}init(_ c: MagcompStatus) {
        self =
            switch c.{{ code }} {
{% for case in one.cases %}
            case {{ case.code }}: {{ made(case) }}
{% endfor %}
            default: unknown("{{ one.name|snake|replace("_", " ") }}", c.{{ code }})
            }
    }
}

{% endfor %}
extension {{ "Axis"|swift }} {
    fileprivate init(_ number: Int64) {
        self =
            switch number {
{% for case in by_name.Axis.cases %}
            case {{ case.code }}: .{{ case.name|camel }}
{% endfor %}
            default: unknown("axis", Int32(truncatingIfNeeded: number))
            }
    }

    var name: String {
        switch self {
{% for case in by_name.Axis.cases %}
        case .{{ case.name|camel }}: "{{ case.name|snake }}"
{% endfor %}
        }
    }
}
