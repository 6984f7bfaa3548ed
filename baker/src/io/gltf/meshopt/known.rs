//! Test streams of meshoptimizer (js/meshopt_decoder.test.js, MIT), and the encoder's input.

pub(super) struct Known {
    pub mode: &'static str,
    pub count: usize,
    pub stride: usize,
    pub filter: Option<&'static str>,
    /// Hexadecimal.
    pub packed: &'static str,
    /// Hexadecimal.
    pub bytes: &'static str,
}

pub(super) const KNOWN: [Known; 17] = [
    // VertexBuffer
    Known {
        mode: "ATTRIBUTES",
        count: 4,
        stride: 12,
        filter: None,
        packed: "a0013f0000005857580126000000010c00000058010800000000000000013f0000001718170126000000010c00000017\
             01080000000000000000000000000000000000000000000000000000000000000000000000",
        bytes: "0000000000000000000000002c01000000000000f401000000002c01000000000000f4012c012c0100000000f401f401",
    },
    // VertexBuffer_More
    Known {
        mode: "ATTRIBUTES",
        count: 16,
        stride: 4,
        filter: None,
        packed: "a000012aaaaaaa0204444444444444440300101010101010101010101010101010000000000000000000000000000000\
             0000000000000000000000000000000000",
        bytes: "000000000001020800020410000306180004082000050a2800060c3000070e380008104000091248000a1450000b1658\
             000c1860000d1a68000e1c70000f1e78",
    },
    // VertexBuffer_Mode2
    Known {
        mode: "ATTRIBUTES",
        count: 16,
        stride: 4,
        filter: None,
        packed: "a0020888888888888888020aaaaaaaaaaaaaaa020ccccccccccccccc020eeeeeeeeeeeeeee0000000000000000000000\
             000000000000000000000000000000000000000000",
        bytes: "0000000004050607080a0c0e0c0f12151014181c14191e23181e242a1c232a3120283038242d363f28323c462c37424d\
             303c485434414e5b384654623c4b5a69",
    },
    // VertexBufferV1
    Known {
        mode: "ATTRIBUTES",
        count: 4,
        stride: 12,
        filter: None,
        packed: "a1eeaaee004b4b4b00004b00007d7d7d00007d00000000000000000000000000000000000000000000620062",
        bytes: "0000000000000000000000002c01000000000000f401000000002c01000000000000f4012c012c0100000000f401f401",
    },
    // VertexBufferV1_Custom
    Known {
        mode: "ATTRIBUTES",
        count: 4,
        stride: 12,
        filter: None,
        packed: "a1d494d4010e005857580202120000000000000300005800000000000000000000000000000002000001000000000200\
             00000000000000030000000000000000000e007d7d7d010000000000007d000000000000000000000000000000000000\
             00000000000162",
        bytes: "0000000000000000000000002c01000000000000f401000000002c01000000000000f4012c012c0100000000f401f401",
    },
    // VertexBufferV1_Deltas
    Known {
        mode: "ATTRIBUTES",
        count: 16,
        stride: 8,
        filter: None,
        packed: "a19999012aaaaaaa02044444444333333302066666666666666602088888888777777700000000000000000000000000\
             00f800f800f000f0000101",
        bytes: "f800f800f000f000f900fa00f300f400fa00fc00f600f800fb00fe00f900fc00fc000001fc000001fd000201ff000401\
             fe00040102010801ff00060105010c010001080108011001010106010b010c01020104010e0108010301020111010401\
             04010001140100010501fe001701fc000601fc001a01f8000701fa001d01f400",
    },
    // VertexBufferV1_BitXorRotate
    Known {
        mode: "ATTRIBUTES",
        count: 4,
        stride: 16,
        filter: None,
        packed: "a1ababfaff0002020200a5c23a00abf9570095428500ddca6d00ac1a50005c99fe004d0c390000000000000000700000\
             000080070c22263b8600001200",
        bytes: "00000000700000000080070c22263b86010000001d0000000000d246b37c695f020000007e0000000080ae6718891c65\
             030000009b00000000000525e1b19b48",
    },
    // IndexBufferV1
    Known {
        mode: "TRIANGLES",
        count: 15,
        stride: 4,
        filter: None,
        packed: "e1f010fe1f3d000a007687566778a9866589689801690000",
        bytes: "000000000100000002000000020000000100000003000000000000000100000002000000020000000100000005000000\
             020000000100000004000000",
    },
    // IndexBufferV1_More
    Known {
        mode: "TRIANGLES",
        count: 12,
        stride: 4,
        filter: None,
        packed: "e1f010fefff00cff020202007687566778a9866589689801690000",
        bytes: "000000000100000002000000020000000100000003000000040000000600000005000000070000000800000009000000",
    },
    // IndexBufferV1_3Edges
    Known {
        mode: "TRIANGLES",
        count: 12,
        stride: 4,
        filter: None,
        packed: "e1f0203040007687566778a9866589689801690000",
        bytes: "000000000100000002000000010000000000000003000000020000000100000004000000000000000200000005000000",
    },
    // IndexSequence
    Known {
        mode: "INDICES",
        count: 6,
        stride: 4,
        filter: None,
        packed: "d10004cd010407981f00000000",
        bytes: "0000000001000000330000000200000031000000e8030000",
    },
    // FilterOct8
    Known {
        mode: "ATTRIBUTES",
        count: 4,
        stride: 4,
        filter: Some("OCTAHEDRAL"),
        packed: "a001070000001e013f0000008b8cfd000126000000000000000000000000000000000000000000000000000000000000\
             0000017f00",
        bytes: "00017f00009f5201ff017f000182f101",
    },
    // FilterOct12
    Known {
        mode: "ATTRIBUTES",
        count: 4,
        stride: 8,
        filter: Some("OCTAHEDRAL"),
        packed: "a0010f0000003d5a010f0000000e0d013f0000009a9926013f0000000e0d0a0000012600000000000000000000000000\
             00000000000000000000000000000000000100ff070000",
        bytes: "00001000ff7f000000006d7f100c0100fc7f1000d701000033017d6fdd3e0100",
    },
    // FilterQuat12
    Known {
        mode: "ATTRIBUTES",
        count: 4,
        stride: 8,
        filter: Some("QUATERNION"),
        packed: "a0010f0000003d5a010f0000000e0d013f0000009a9926013f0000000e0d0a0000012a00000000000000000000000000\
             000000000000000000000000000000000001000000fc07",
        bytes: "ff7f00000b0000000000b5610000ae520b000000d05b2e599e007b3900005d72",
    },
    // FilterExp
    Known {
        mode: "ATTRIBUTES",
        count: 1,
        stride: 16,
        filter: Some("EXPONENTIAL"),
        packed: "a0000000000000000000000000000000000000000000000000000000000000000000000000030000fff7ffff02ffff7f\
             fe",
        bytes: "000000000000c03f000010c2feffff49",
    },
    // FilterColor8
    Known {
        mode: "ATTRIBUTES",
        count: 4,
        stride: 4,
        filter: Some("COLOR"),
        packed: "a0013f0000007e7d4c013f000000fdfdfe013f000000838280013f0000007d3f7e000000000000000000000000000000\
             00000000000000000000000000407fc1ff",
        bytes: "fe0100ff00fe00800100ff40666666bf",
    },
    // FilterColor12
    Known {
        mode: "ATTRIBUTES",
        count: 4,
        stride: 8,
        filter: Some("COLOR"),
        packed: "a0011b000000cc013f0000000605040129000000013f0000000d0f10013800000003013f000000161508012100000001\
             3f0000000503060000000000000000000000000000000000000000000000000004ff0701fcff0f",
        bytes: "efff10000000ffff0000efff0000088010000000ffff0440666666666666fbbf",
    },
];
