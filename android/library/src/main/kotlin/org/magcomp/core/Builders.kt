// made by bindings/generate.sh from bindings/config.toml
package org.magcomp.core

// For Java, which has no named arguments. A field that is not set has the library's default; null unsets a field.

/** Makes a [CompensationConfig] from Java: `new CompensationConfigBuilder().method(...).build()`. */
public class CompensationConfigBuilder {
    private var built = CompensationConfig()

    /** Sets [CompensationConfig.method]. */
    public fun method(value: CompensationMethod?): CompensationConfigBuilder = apply { built = built.copy(method = value) }

    /** Sets [CompensationConfig.initial]. */
    public fun initial(value: MagnetometerCalibration?): CompensationConfigBuilder = apply { built = built.copy(initial = value) }

    /** Sets [CompensationConfig.initialSigmaUt]. */
    public fun initialSigmaUt(value: Double?): CompensationConfigBuilder = apply { built = built.copy(initialSigmaUt = value) }

    /** Sets [CompensationConfig.useReportedHardIron]. */
    public fun useReportedHardIron(value: Boolean?): CompensationConfigBuilder = apply { built = built.copy(useReportedHardIron = value) }

    /** Sets [CompensationConfig.rangeUt]. */
    public fun rangeUt(value: Double?): CompensationConfigBuilder = apply { built = built.copy(rangeUt = value) }

    /** Sets [CompensationConfig.railUt]. */
    public fun railUt(value: Double?): CompensationConfigBuilder = apply { built = built.copy(railUt = value) }

    /** Sets [CompensationConfig.fieldStrengthUt]. */
    public fun fieldStrengthUt(value: Double?): CompensationConfigBuilder = apply { built = built.copy(fieldStrengthUt = value) }

    /** Sets [CompensationConfig.heading]. */
    public fun heading(value: HeadingConfig?): CompensationConfigBuilder = apply { built = built.copy(heading = value) }

    /** Sets [CompensationConfig.windowed]. */
    public fun windowed(value: WindowedConfig?): CompensationConfigBuilder = apply { built = built.copy(windowed = value) }

    /** What was set so far. */
    public fun build(): CompensationConfig = built
}

/** Makes a [HeadingConfig] from Java: `new HeadingConfigBuilder().axis(...).build()`. */
public class HeadingConfigBuilder {
    private var built = HeadingConfig()

    /** Sets [HeadingConfig.axis]. */
    public fun axis(value: ReferenceAxis?): HeadingConfigBuilder = apply { built = built.copy(axis = value) }

    /** Sets [HeadingConfig.screenRotation]. */
    public fun screenRotation(value: ScreenRotation?): HeadingConfigBuilder = apply { built = built.copy(screenRotation = value) }

    /** Sets [HeadingConfig.declinationDeg]. */
    public fun declinationDeg(value: Double?): HeadingConfigBuilder = apply { built = built.copy(declinationDeg = value) }

    /** Sets [HeadingConfig.tiltSigmaDeg]. */
    public fun tiltSigmaDeg(value: Double?): HeadingConfigBuilder = apply { built = built.copy(tiltSigmaDeg = value) }

    /** What was set so far. */
    public fun build(): HeadingConfig = built
}
