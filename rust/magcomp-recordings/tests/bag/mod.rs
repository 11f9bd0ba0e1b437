//! Bags of ROS 2, for the tests of this crate and of the command.

use std::collections::BTreeMap;
use std::io::Cursor;

/// A bag of so many field messages, a few in each chunk, packed or not.
pub fn bag(messages: u32, compression: Option<mcap::Compression>, log_time: u64) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let options = mcap::WriteOptions::new().chunk_size(Some(2048)).compression(compression);
    let mut writer = options.create(&mut bytes).unwrap();
    let schema = writer.add_schema("sensor_msgs/msg/MagneticField", "ros2msg", b"").unwrap();
    let channel = writer.add_channel(schema, "/mag", "cdr", &BTreeMap::new()).unwrap();
    for k in 0..messages {
        let mut data = vec![0, 1, 0, 0];
        let stamp = if log_time > 0 { [0, 0] } else { [1_700_000_000, k * 10_000_000] };
        stamp.iter().for_each(|word| data.extend(word.to_le_bytes()));
        data.extend(4_u32.to_le_bytes());
        data.extend(b"mag\0");
        let numbers = [2e-5, 3e-5, -4e-5 - 1e-7 * f64::from(k)].into_iter().chain([0.0; 9]);
        numbers.for_each(|number| data.extend(number.to_le_bytes()));
        let time = log_time + u64::from(k);
        let header =
            mcap::records::MessageHeader { channel_id: channel, sequence: k, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, &data).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    bytes.into_inner()
}
