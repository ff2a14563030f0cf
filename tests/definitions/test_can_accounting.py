"""Parts of KCD, SYM and ARXML files that cantools ignores are counted with name, place
and line; parts that it reads or that have no meaning are not.
"""

from __future__ import annotations

import pytest

from icdgen.definitions import safe_xml
from icdgen.definitions.accounting import Account
from icdgen.definitions.can_accounting import (
    _KCD,
    account_for_arxml,
    account_for_kcd,
    account_for_sym,
)


def counted(account):
    """Return owner, key, number, place and line of each counted part."""
    return [
        (owner, key, entry.times, entry.place, entry.line)
        for (owner, key), entry in account.entries.items()
    ]


def of_xml(count, text):
    account = Account()
    count(safe_xml.parse("file.xml", text.encode(), account=account), account)
    return counted(account)


def of_sym(text):
    account = Account()
    account_for_sym(text, account)
    return counted(account)


EVERY_KCD_PART = """\
<n:NetworkDefinition xmlns:n="urn:kcd" xmlns:x="urn:x" x:schemaLocation="a"
 noNamespaceSchemaLocation="b">
  <n:Document name="a" author="a" company="a" date="a" version="a"/>
  <n:Node id="1" name="a"/>
  <n:Bus name="a">
    <n:Message name="a" id="1" format="a" length="1" interval="1" triggered="a">
      <n:Notes/><n:Producer><n:NodeRef id="1"/></n:Producer>
      <n:Multiplex name="a" offset="0" length="1" endianess="a">
        <n:MuxGroup count="1"><n:Signal name="a"/></n:MuxGroup>
        <n:Value min="0" max="1" slope="1" intercept="0" unit="a" type="a"/>
        <n:Notes/><n:LabelSet><n:Label name="a" value="0" type="a"/></n:LabelSet>
        <n:Consumer><n:NodeRef id="1"/></n:Consumer>
      </n:Multiplex>
      <n:Signal name="a" offset="0" length="1" endianess="a">
        <n:Value min="0"/><n:Notes/><n:LabelSet/><n:Consumer/>
      </n:Signal>
    </n:Message>
  </n:Bus>
</n:NetworkDefinition>
"""


def test_parts_of_kcd_that_are_read_are_not_counted():
    assert of_xml(account_for_kcd, EVERY_KCD_PART) == []


@pytest.mark.parametrize("owner", sorted(_KCD))
def test_every_other_attribute_and_element_of_kcd_is_counted(owner):
    text = f'<{owner} name="N" odd="1">\n<!-- odd -->\n<Odd/><Odd/></{owner}>'
    place = "`N`"
    own = [(owner, "odd", 1, place, 1), (owner, "Odd", 2, place, 3)]
    result = of_xml(account_for_kcd, text)
    assert [row for row in result if row[1] != "name"] == own
    assert (("name" in _KCD[owner]) + (len(result) - 2)) == 1


def test_parts_of_an_element_of_kcd_that_is_not_read_are_counted_with_it():
    text = '<Bus name="B"><Odd odd="1"/><Message name="M"><Odd/></Message></Bus>'
    assert of_xml(account_for_kcd, text) == [
        ("Bus", "Odd", 1, "`B`", 1),
        ("Message", "Odd", 1, "`M`", 1),
    ]


def test_parts_of_kcd_are_counted_in_the_order_of_the_file():
    text = """\
<Bus>
<Message name="A"><Odd/></Message>
<Message name="B"><Odd/></Message>
</Bus>"""
    assert of_xml(account_for_kcd, text) == [("Message", "Odd", 2, "`A`", 2)]


EVERY_SYM_PART = """\
FormatVersion=6.0 // a /b: comment
Title="a /x: b"
UniqueVariables=True
FloatDecimalPlaces=2
BRS=1
Enum=Power(0="off", 1="on /y:")
1=not a key

[Status]
Type=Extended
ID=100h
Len=8
CycleTime=5 // p
Color=FF00FFh
Mux=Page 0,8 1
Sig="String"
Var=Level unsigned 0,8 /u:"\\"/z:" /f:2 /o:1 /min:0 /max:9 /e:Power /spn:5
"""


def test_parts_of_a_symbol_file_that_are_read_or_have_no_meaning_are_not_counted():
    assert of_sym(EVERY_SYM_PART) == []


def test_keys_and_attributes_of_a_symbol_file_are_counted_with_symbol_and_line():
    text = """\
Timeout=5

["Fast Status"]
 Timeout = 6 /d:1 // /e2:
Var=Level unsigned 0,8 /d:1 /u:"/x:"
[Slow]
Var=Level unsigned 0,8 /h:1 /d:2
Timeout=7
"""
    assert of_sym(text) == [
        ("", "Timeout", 3, "", 1),
        ("Timeout", "/d:", 1, "`Fast Status`", 4),
        ("Var", "/d:", 2, "`Fast Status`", 5),
        ("Var", "/h:", 1, "`Slow`", 7),
    ]


@pytest.mark.parametrize(
    ("line", "kind"),
    [
        ("Sig=Serial string 8", "string"),
        ('Var="Serial No" raw 8,32', "raw"),
        ("Var = Serial char 8,8", "char"),
        ("Sig=Serial unsigned 8", None),
        ("Sig=string unsigned 8", None),
        ("Sig=Serial characters 8", None),
    ],
)
def test_types_of_a_symbol_file_that_become_numbers_are_counted(line, kind):
    key = line[:3]
    expected = [(key, f"type {kind}", 1, "", 1)] if kind else []
    assert of_sym(line) == expected


ARXML = """\
<AUTOSAR xmlns="http://autosar.org/schema/r4.0"><AR-PACKAGES><AR-PACKAGE>
<ELEMENTS>
<!-- LIN -->
<CAN-FRAME><SHORT-NAME>Frame</SHORT-NAME></CAN-FRAME>
<LIN-CLUSTER><LONG-NAME>Long</LONG-NAME><SHORT-NAME>Doors</SHORT-NAME></LIN-CLUSTER>
<LIN-CLUSTER><SHORT-NAME>Windows</SHORT-NAME></LIN-CLUSTER>
<ETHERNET-CLUSTER/>
</ELEMENTS>
<OTHER><FLEXRAY-CLUSTER/></OTHER>
</AR-PACKAGE></AR-PACKAGES></AUTOSAR>
"""


def test_elements_of_arxml_packages_of_other_buses_are_counted_by_kind():
    assert of_xml(account_for_arxml, ARXML) == [
        ("ELEMENTS", "LIN-CLUSTER", 2, "`Doors`", 5),
        ("ELEMENTS", "ETHERNET-CLUSTER", 1, "", 7),
    ]


@pytest.mark.parametrize(
    "kind",
    [
        "SW-BASE-TYPE", "CAN-CLUSTER", "CAN-FRAME", "COMPU-METHOD", "ECU-INSTANCE",
        "I-SIGNAL", "I-SIGNAL-GROUP", "I-SIGNAL-I-PDU", "MULTIPLEXED-I-PDU", "N-PDU",
        "NM-PDU", "GENERAL-PURPOSE-PDU", "SYSTEM", "SYSTEM-SIGNAL", "UNIT",
        "SYSTEM-SIGNAL-GROUP", "CONTAINER-I-PDU", "SECURED-I-PDU", "DATA-CONSTR",
    ],
)  # fmt: skip
def test_elements_of_arxml_that_describe_can_are_not_counted(kind):
    assert of_xml(account_for_arxml, f"<A><ELEMENTS><{kind}/></ELEMENTS></A>") == []
