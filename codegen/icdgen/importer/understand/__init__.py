"""Tables -> what they say about messages, enumerations, lists and logs."""
