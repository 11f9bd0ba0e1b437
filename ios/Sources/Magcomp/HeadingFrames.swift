extension DeviceAttitude {
    /// How a device lies by one corrected field and one `up`, in their device frame: device to east, magnetic north and up. Nil
    /// where the two have one direction, or one has none.
    ///
    /// - Parameters:
    ///   - fieldUt: the corrected field, microtesla
    ///   - up: any length, pointing up
    @_spi(Research) public init?(fieldUt: DeviceVector, up: DeviceVector) throws {
        guard let found = try attitude(fieldUt: fieldUt, up: up) else { return nil }
        self = found
    }
}

extension CompassHeading {
    /// The heading and inclination of one corrected field and one `up`, in their device frame. Nil where the axis is vertical,
    /// or a vector has no direction.
    ///
    /// - Parameters:
    ///   - fieldUt: the corrected field, microtesla
    ///   - up: any length, pointing up
    ///   - frame: the axis whose heading it is; with a declination there is a true heading
    @_spi(Research) public init?(fieldUt: DeviceVector, up: DeviceVector, frame: HeadingFrame) throws {
        guard let found = try heading(fieldUt: fieldUt, up: up, frame: frame) else { return nil }
        self = found
    }

    /// Clockwise from true north, degrees, 0 to 360.
    ///
    /// - Parameters:
    ///   - headingDeg: clockwise from magnetic north, degrees
    ///   - declinationDeg: from true to magnetic north, degrees, east positive
    @_spi(Research) public static func trueHeadingDeg(headingDeg: Double, declinationDeg: Double) -> Double {
        Magcomp.trueHeadingDeg(headingDeg: headingDeg, declinationDeg: declinationDeg)
    }
}

extension HeadingFrame.ScreenRotation {
    /// By the raw value of a `UIInterfaceOrientation`: 1 portrait, 2 upside down, 3 landscape with the home button's edge
    /// to the right (the device was turned counter-clockwise), 4 to the left. Nil for any other, which is none.
    init?(interfaceOrientation rawValue: Int) {
        switch rawValue {
        case 1: self = .deg0
        case 2: self = .deg180
        case 3: self = .deg90
        case 4: self = .deg270
        default: return nil
        }
    }
}

#if canImport(UIKit) && os(iOS)
import UIKit

extension HeadingFrame.ScreenRotation {
    /// How far the screen has turned, by the window scene's orientation; nil for `.unknown`, which tells nothing: leave
    /// ``Compass/screenRotation`` as it is then.
    public init?(_ orientation: UIInterfaceOrientation) { self.init(interfaceOrientation: orientation.rawValue) }
}
#endif
