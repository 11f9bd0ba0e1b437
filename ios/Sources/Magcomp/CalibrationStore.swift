import Foundation

/// Where a calibration is kept from one launch to the next. The text is JSON with its own
/// version, source, date and covariance; a store need not look into it. Of a text that is damaged or of a newer version nothing is
/// taken over, and ``CompensatedReading/storeError`` tells it.
public protocol CalibrationStore: Sendable {
    /// The text that was saved last, or nil. Called in the background when readings begin, which wait for it; nothing else does.
    func load() -> String?

    /// Keeps a text in the place of the one before. Never called while nothing was learned from live samples, so neither the
    /// system's hard iron nor what ``load()`` gave is ever saved as learned. Called in the background: when the status is first `.tracking`,
    /// then when the calibration has changed and 10 s have passed since the save before, and at the end of the
    /// readings; and when the app calls ``Compass/save()``. A change of hard iron or soft iron counts. A change
    /// of the field strength alone does not, because it follows the noise of a device at rest. Never called when
    /// ``load()`` or the save before has kept the same, nor twice at once. The readings of a recording wait for it, those of
    /// sensors and the app's main thread do not.
    func save(_ text: String)

    /// Keeps nothing from now on, until it is told to save: called in the background after ``Compass/reset()``.
    func clear()
}

/// Keeps the calibration in user defaults.
public struct UserDefaultsStore: CalibrationStore {
    private let suiteName: String?
    private let key: String

    /// - Parameters:
    ///   - suiteName: the suite of an app group; nil: the app's own defaults
    ///   - key: under which key
    public init(suiteName: String? = nil, key: String = "org.magcomp.calibration") {
        self.suiteName = suiteName
        self.key = key
    }

    private var defaults: UserDefaults { suiteName.flatMap { UserDefaults(suiteName: $0) } ?? .standard }

    public func load() -> String? { defaults.string(forKey: key) }

    public func save(_ text: String) { defaults.set(text, forKey: key) }

    public func clear() { defaults.removeObject(forKey: key) }
}
